"""What photos go through between the scene and the file: the cells of `facecrf bench stress`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

# OpenCV's codes of the chroma's resolution in a JPEG.
SAMPLINGS = ("4:4:4", "4:2:2", "4:2:0")


@dataclass(frozen=True, slots=True)
class Conditions:
    """One photo's way, in the order in which things happen.

    Attributes
    ----------
    saturation
        Factor on the distance of each color from its gray.
    gains
        Of red, green and blue: another white balance.
    exposure
        [EV] Light is multiplied with two to the power of it.
    megapixels
        Size to which the scene is enlarged before the camera; None for its own, at least 0.3.
    blur
        [pixel] Deviation of the lens's Gaussian blur.
    iso
        Sensitivity whose photon and read noise the sensor adds; None for a sensor without noise.
    mosaic
        Whether the sensor sees one color a pixel, which is interpolated.
    denoise_before
        Strength of the noise reduction on linear light, in deviations of the noise at mid-gray
        (of ISO 400 where the sensor has none).
    denoise_after
        [8-bit codes] Strength of non-local means on the encoded photo.
    sharpen, sharpen_radius
        Amount of the unsharp mask on encoded luma, and its deviation [pixel].
    halve
        Whether the photo is stored at half its width.
    quality, sampling
        Of the JPEG; None for a file without loss.
    """

    saturation: float = 1.0
    gains: tuple[float, float, float] = (1.0, 1.0, 1.0)
    exposure: float = 0.0
    megapixels: float | None = None
    blur: float = 0.0
    iso: float | None = None
    mosaic: bool = False
    denoise_before: float = 0.0
    denoise_after: float = 0.0
    sharpen: float = 0.0
    sharpen_radius: float = 1.0
    halve: bool = False
    quality: int | None = None
    sampling: str = "4:2:0"

    @property
    def own_grain(self) -> bool:
        """Whether noise comes from this camera, so that the scene should have none of its own."""
        return self.iso is not None


Draw = Callable[[np.random.Generator], Conditions]


@dataclass(frozen=True, slots=True)
class Cell:
    """A row of the table.

    Attributes
    ----------
    name
        As `--cells` takes it.
    draw
        Conditions of one photo.
    weight
        Photos of it, as a multiple of `--count`; large ones are sparse, the headline is not.
    """

    name: str
    draw: Draw
    weight: float = 1.0


def a_day(generator: np.random.Generator) -> Conditions:
    """A photo as people take it, of a mixed lot: the headline of the stress table."""
    uniform, chance = generator.uniform, generator.random
    gains = np.exp(generator.normal(0.0, 0.1, 3))
    return Conditions(
        saturation=uniform(0.5, 1.3),
        gains=(float(gains[0]), float(gains[1]), float(gains[2])),
        exposure=generator.normal(0.0, 1.0),
        megapixels=uniform(1.5, 6.0),
        iso=100.0 * 2.0 ** uniform(0.0, 5.0),
        mosaic=True,
        denoise_before=uniform(1.0, 2.5) if chance() < 0.6 else 0.0,
        sharpen=uniform(0.3, 1.0) if chance() < 0.5 else 0.0,
        sharpen_radius=uniform(0.7, 1.5),
        halve=bool(chance() < 0.3),
        quality=int(generator.integers(86, 98)),
        sampling=str(generator.choice(SAMPLINGS, p=(0.2, 0.4, 0.4))),
    )


def _always(**changes: object) -> Draw:
    return partial(_same, replace(Conditions(), **changes))  # type: ignore[arg-type]


def _same(conditions: Conditions, _: np.random.Generator) -> Conditions:
    """Of every photo; a lambda could not be sent to another process."""
    return conditions


def _cells() -> tuple[Cell, ...]:
    native = {"iso": 400.0, "mosaic": True, "quality": 95, "sampling": "4:2:2"}
    jpegs = [(q, s) for q in (98, 92, 85) for s in ("4:2:0", "4:2:2")]
    return (
        Cell("day", a_day, 3.0),
        Cell("as it is", _always()),
        *(Cell(f"{ev:+g} EV", _always(exposure=float(ev))) for ev in (-3, -2, -1, 1, 1.5)),
        *(Cell(f"saturation {s:g}", _always(saturation=s)) for s in (0.15, 0.5, 1.5)),
        Cell("warm", _always(gains=(1.25, 1.0, 0.75))),
        Cell("cold", _always(gains=(0.8, 1.0, 1.3))),
        Cell("half size", _always(halve=True)),
        Cell("blur", _always(blur=1.0)),
        Cell("sharpened", _always(sharpen=0.8)),
        Cell("denoised before", _always(denoise_before=2.0)),
        Cell("denoised after", _always(denoise_after=4.0)),
        *(Cell(f"JPEG {q} {s}", _always(quality=q, sampling=s)) for q, s in jpegs),
        Cell("0.3 MP", _always(megapixels=0.3, **native)),
        Cell("1 MP", _always(megapixels=1.0, **native)),
        Cell("3 MP", _always(megapixels=3.0, **native), 0.5),
        Cell("12 MP", _always(megapixels=12.0, **native), 0.25),
    )


CELLS = _cells()
