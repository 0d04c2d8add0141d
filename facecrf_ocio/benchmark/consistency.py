"""`facecrf bench consistency`: what estimates of anyone's photos must satisfy, without any truth.

A photo sent through a known increasing curve h must get the estimate g(h^-1). A photo that was
linearized and encoded as sRGB must get sRGB. Photos of one camera must agree. An error that is
common to all is not seen: these tests belong beside those that know the truth.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import cv2
import numpy as np

from facecrf_ocio.benchmark.cases import code_digest
from facecrf_ocio.benchmark.laid_out import markdown_table, number
from facecrf_ocio.benchmark.metrics import score
from facecrf_ocio.benchmark.tables import mean_of
from facecrf_ocio.benchmark.virtual_camera import count_codes
from facecrf_ocio.benchmark.written import write_cases
from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.errors import FaceCRFError
from facecrf_ocio.files.versions import versions
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.values import Estimate, Float, InverseCRF, Photo

EQUIVARIANCE = "through a known curve"
SRGB = "encoded as sRGB"
AGREEMENT = "of one camera"
LEGEND = """\
through a known curve: each photo is sent through increasing curves h, in 8 bits, and its estimate
held against g(h^-1). encoded as sRGB: it is linearized by its estimate, encoded as sRGB in 8 bits,
and the new estimate held against sRGB. Codes are spread over their width before, so that none is
left out by what they go through. of one camera: the estimate of each photo is held against
the mean curve of the others whose files name the same camera. Differences in stops, with one free
factor taken out at code 128, over codes 64 to 235 and over the shadows 16 to 64, and as RMSE x 100.
band: share of codes at which the difference lies within the 90 % band in stops."""
_GRID = np.linspace(0.0, 1.0, 1024)  # encoded values, as many as a stored response has
_BEND = 0.06  # of full scale: as much as a tone curve of a photo editor is commonly bent


@dataclass(frozen=True, slots=True)
class Difference:
    """One comparison: `mid`, `shadows`, `rmse`, `band` as in `metrics.Score`."""

    test: str
    photo: str
    curve: str
    mid: float
    shadows: float
    rmse: float
    band: float | None


@dataclass(frozen=True, slots=True)
class Consistency:
    """All comparisons, and in one line each which photos had no estimate and why."""

    differences: tuple[Difference, ...]
    left_out: tuple[str, ...]


def known_curves() -> dict[str, Float]:
    """Increasing curves from encoded to encoded values, (1024,) each, from 0 to 1."""
    bend = np.sin(2.0 * np.pi * _GRID)
    powers = {f"power {p:g}": _GRID**p for p in (0.75, 0.87, 1.15, 1.33)}
    bent = {"more contrast": _GRID - _BEND * bend, "less contrast": _GRID + _BEND * bend}
    return {**powers, **bent}


def measure_consistency(
    paths: Sequence[Path],
    *,
    half: bool = False,
    progress: Callable[[int, int], None] = lambda *_: None,
) -> Consistency:
    """Run all three tests.

    Parameters
    ----------
    paths
        Photos.
    half
        Whether they are taken at half their width, which saves time.
    progress
        Called with the number of finished photos and of all.
    """
    found: list[tuple[str, Photo, Estimate]] = []
    differences: list[Difference] = []
    left_out = []
    for done, path in enumerate(paths):
        progress(done, len(paths))
        try:
            photo = _halved(read_photo(path)) if half else read_photo(path)
        except FaceCRFError as error:
            left_out.append(str(error))
            continue
        estimate = calibrate(photo)
        if estimate.found is None or photo.scene_linear:
            left_out.append(f"{path}: {estimate.reason}")
            continue
        differences += [*_through_curves(path.name, photo, estimate)]
        differences += [*_as_srgb(path.name, photo, estimate)]
        found.append((path.name, _without_pixels(photo), estimate))
    progress(len(paths), len(paths))
    return Consistency((*differences, *_agreement(found)), tuple(left_out))


def consistency_markdown(found: Consistency) -> str:
    """A row for each test, and what the columns mean."""
    headings = ["test", "comparisons", "stops median", "mean", "95 %", "shadows", "95 %"]
    headings += ["RMSE median", "mean", "95 %", "band %"]
    tests = dict.fromkeys(difference.test for difference in found.differences)
    cells = [[test, *_cells([d for d in found.differences if d.test == test])] for test in tests]
    return "\n\n".join([markdown_table(headings, cells) if cells else "No photo to test.", LEGEND])


def write_consistency(found: Consistency, output: Path) -> tuple[Path, ...]:
    """Write `consistency.md`, `consistency.csv` and `consistency.json` to a folder that exists."""
    cases = [asdict(difference) for difference in found.differences]
    run = {
        "versions": versions(),
        "code": code_digest(),
        "photos": len({d.photo for d in found.differences}),
        "left_out": list(found.left_out),
    }
    return write_cases(output, "consistency", f"{consistency_markdown(found)}\n", run, cases)


def _through_curves(name: str, photo: Photo, estimate: Estimate) -> Iterator[Difference]:
    """Compare with g(h^-1), for every h."""
    encoded = _spread(photo)
    for curve, h in known_curves().items():
        changed = photo_in_8_bits(photo, np.interp(encoded, _GRID, h))
        back = np.interp(_GRID, h, _GRID)
        inverse = estimate.curve
        truth = np.array([np.interp(back, inverse.encoded, row) for row in inverse.linear])
        yield from _difference((EQUIVARIANCE, name, curve), changed, truth)


def _as_srgb(name: str, photo: Photo, estimate: Estimate) -> Iterator[Difference]:
    srgb = decode_srgb(_GRID)
    encoded = np.interp(estimate.curve.linearize(_spread(photo)), srgb, _GRID)
    truth = np.tile(srgb, (3, 1))
    yield from _difference((SRGB, name, "sRGB"), photo_in_8_bits(photo, encoded), truth)


def _spread(photo: Photo) -> Float:
    """Its encoded values, each somewhere within its code, in [0, 1]; the same every time.

    A curve leaves gaps between codes where it rises by more than one. Photos have none, and cues
    would read the curve from them (as a fifth of what they find).
    """
    width = 1.0 / (2.0 ** (photo.bit_depth or 8) - 1.0)
    within = np.random.default_rng(0).random(photo.encoded.shape, np.float32) - 0.5
    return np.clip(photo.encoded + np.float32(width) * within, 0.0, 1.0)


def _difference(case: tuple[str, str, str], photo: Photo, truth: Float) -> Iterator[Difference]:
    """None where the changed photo has no estimate any more."""
    again = calibrate(photo)
    if again.found is None:
        return
    errors = score(again.found, again.confidence, truth, count_codes(photo))
    yield Difference(*case, errors.mid, errors.shadows, errors.rmse, errors.band_stops)


def _agreement(found: Sequence[tuple[str, Photo, Estimate]]) -> Iterator[Difference]:
    """Each photo of a camera against the mean of its others."""
    cameras: dict[tuple[str, str, str], list[tuple[str, Photo, Estimate]]] = {}
    for one in found:
        camera = one[1].camera
        if camera.make or camera.model:
            cameras.setdefault((camera.make, camera.model, camera.software), []).append(one)
    for (make, model, _), members in cameras.items():
        for name, photo, estimate in members:
            others = [_sampled(e.curve) for other, _, e in members if other != name]
            if others:
                truth = np.mean(others, axis=0)
                errors = score(estimate.curve, estimate.confidence, truth, count_codes(photo))
                yield Difference(
                    AGREEMENT,
                    name,
                    f"{make} {model}".strip(),
                    errors.mid,
                    errors.shadows,
                    errors.rmse,
                    errors.band_stops,
                )


def _sampled(curve: InverseCRF) -> Float:
    return np.array([np.interp(_GRID, curve.encoded, row) for row in curve.linear])


def photo_in_8_bits(photo: Photo, encoded: Float) -> Photo:
    """The photo with other encoded values (H, W, 3), clipped to [0, 1] and rounded to codes."""
    codes = np.rint(np.clip(encoded, 0.0, 1.0) * 255.0)
    return replace(photo, encoded=np.asarray(codes / 255.0, np.float32), bit_depth=8)


def _halved(photo: Photo) -> Photo:
    height, width = photo.encoded.shape[:2]
    size = (max(1, width // 2), max(1, height // 2))
    encoded = np.asarray(cv2.resize(photo.encoded, size, interpolation=cv2.INTER_AREA), np.float32)
    alpha = None  # nothing here looks at it
    return photo_in_8_bits(replace(photo, encoded=encoded, alpha=alpha), encoded)


def _without_pixels(photo: Photo) -> Photo:
    """What is kept of a photo while others are read."""
    return replace(photo, encoded=photo.encoded[:1, :1], alpha=None)


def _cells(group: Sequence[Difference]) -> list[str]:
    def spread(values: list[float], factor: float, digits: int) -> list[str]:
        numbers = factor * np.array(values)
        shown = (np.median(numbers), numbers.mean(), np.percentile(numbers, 95))
        return [f"{value:.{digits}f}" for value in shown]

    return [
        str(len(group)),
        *spread([d.mid for d in group], 1.0, 3),
        *spread([d.shadows for d in group], 1.0, 3)[1:],
        *spread([d.rmse for d in group], 100.0, 2),
        number(mean_of(d.band for d in group), 100, 0),
    ]
