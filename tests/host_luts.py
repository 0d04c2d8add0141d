"""The LUTs that every host is given, and the pixels that must come of them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib.cbook
import numpy as np
import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio import calibrate, read_photo
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.values import InverseCRF

FORMATS = ("spi1d", "cube", "clf", "ctf", "csp")
CURVES = ("channels", "joint")
CASES = tuple((curve, name) for curve in CURVES for name in FORMATS)


@dataclass(frozen=True)
class HostLuts:
    """`files` in the order of CASES; pixels (256, 256, 3) before, and by curve after."""

    files: tuple[Path, ...]
    codes: np.ndarray
    linear: dict[str, np.ndarray]
    image: Path


def make_host_luts(folder: Path) -> HostLuts:
    """Write every curve in every format, and an image with all 16-bit codes in every channel."""
    nodes = np.linspace(0.0, 1.0, 4096)
    rows = np.stack([nodes**1.6, nodes**2.6, np.sin(1.5 * nodes) / np.sin(1.5)])
    curves = {"channels": InverseCRF(nodes, rows), "joint": estimated_curve()}
    files = tuple(
        write_lut(curves[curve], folder / f"{curve}_{name}.{name}") for curve, name in CASES
    )
    order = np.random.default_rng(0)
    channels = [order.permutation(65536).reshape(256, 256) for _ in range(3)]
    codes = (np.stack(channels, axis=-1) / 65535).astype(np.float32)
    image = folder / "codes.tif"
    out = oiio.ImageBuf(codes)
    out.specmod().attribute("oiio:ColorSpace", "data")
    assert out.write(str(image))
    linear = {name: curve.linearize(codes) for name, curve in curves.items()}
    return HostLuts(files, codes, linear, image)


def estimated_curve() -> InverseCRF:
    """What `joint` says of the portrait that matplotlib ships."""
    portrait = matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)
    estimate = calibrate(read_photo(portrait), estimator="joint")
    assert estimate.curve is not None
    return estimate.curve
