"""Exposure brackets among a camera's photos: one scene, one setting, different exposures.

People shoot them over minutes, in any order, and with other photos between them: so the picture
decides, and time only bounds how far is looked.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import log2

import numpy as np
from scipy.stats import spearmanr

from facecrf_ocio.pair.bracket_curve import HIGHEST, LOWEST
from facecrf_ocio.pair.code_samples import Samples, read_samples
from facecrf_ocio.pair.exposure_grid import stops_of_shots
from facecrf_ocio.photo.shot import Shot
from facecrf_ocio.values import Float

SECONDS = 180.0
"""[s] Between a photo and the last of a bracket that it may belong to. A set of 13 shots to 13 s,
by hand, had pauses of up to 85 s."""
AT_ONCE = 5.0  # [s] within which a camera's own bracketing goes on
_LEAST_STEP = 0.2  # [stop] by which exposures differ that are meant to differ: 1/3, as EXIF rounds
_LEAST_ALIKE = 0.85  # rank correlation of code values; a response does not change ranks
_STILL_ALIKE = 0.95  # of photos that are not taken at once: a tripod stood there
_FEWEST_POINTS = 60  # clear in both photos: chance gives their rank correlation a deviation of 0.13


@dataclass(frozen=True, slots=True, eq=False)
class BracketPhoto:
    """One photo that may belong to a bracket."""

    name: str
    sha256: str
    shot: Shot
    samples: bytes

    @property
    def stops(self) -> float:
        """log2 of the exposure, by time, f-number and sensitivity, as EXIF has them."""
        aperture, iso = self.shot.aperture or 1.0, self.shot.iso or 1.0
        return log2(self.shot.exposure_s * iso / aperture**2)


def stops_of(members: Iterable[BracketPhoto]) -> Float:
    """(J,) exposures of a bracket on the camera's grid."""
    return stops_of_shots([one.shot for one in members])


def find_brackets(exposures: Iterable[BracketPhoto]) -> Iterator[tuple[BracketPhoto, ...]]:
    """Yield the brackets of a camera, of two photos or more.

    Parameters
    ----------
    exposures
        In the order of their times; each has a time and an exposure time.
    """
    open_series: list[list[BracketPhoto]] = []
    for one in exposures:
        for done in [s for s in open_series if _pause(s, one) > SECONDS]:
            open_series.remove(done)
            if len(done) > 1:
                yield tuple(done)
        if any(one.sha256 == member.sha256 for series in open_series for member in series):
            continue
        home = next((s for s in reversed(open_series) if _belongs(s, one)), None)
        if home is None:
            open_series.append([one])
        else:
            home.append(one)
    yield from (tuple(series) for series in open_series if len(series) > 1)


def _pause(series: list[BracketPhoto], one: BracketPhoto) -> float:
    """[s] Between the end of the series' last exposure and the start of this one."""
    return one.shot.taken - series[-1].shot.taken - series[-1].shot.exposure_s


def _belongs(series: list[BracketPhoto], one: BracketPhoto) -> bool:
    """Whether a photo shows what its neighbor in exposure shows, with an exposure not yet there."""
    nearest = min(series, key=lambda member: abs(member.stops - one.stops))
    known = [(e.shot.aperture > 0.0, e.shot.iso > 0.0) for e in (nearest, one)]
    if known[0] != known[1] or abs(nearest.stops - one.stops) < _LEAST_STEP:
        return False
    least = _LEAST_ALIKE if _pause(series, one) <= AT_ONCE else _STILL_ALIKE
    return _same_scene(nearest, one, least)


def _same_scene(one: BracketPhoto, other: BracketPhoto, least: float) -> bool:
    """Whether two photos have the same picture up to exposure, and the longer is the brighter."""
    first, second = (_green(e.samples) for e in (one, other))
    brighter = float(second.mean()) - float(first.mean())
    if brighter * (other.stops - one.stops) <= 0.0:
        return False
    clear = (first >= LOWEST) & (first <= HIGHEST) & (second >= LOWEST) & (second <= HIGHEST)
    first, second = first[clear], second[clear]
    if len(first) < _FEWEST_POINTS or np.ptp(first) == 0 or np.ptp(second) == 0:
        return False
    return float(spearmanr(first, second).statistic) >= least


def _green(samples: bytes) -> Samples:
    return read_samples(samples)[:, 1]
