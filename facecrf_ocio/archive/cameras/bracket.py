"""Exposure brackets: photos of one scene within seconds, with different exposures."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import log2

import numpy as np
from scipy.stats import spearmanr

from facecrf_ocio.archive.task import Shot
from facecrf_ocio.pair.code_samples import Samples, read_samples
from facecrf_ocio.pair.debevec import HIGHEST, LOWEST

SECONDS = 5.0
"""[s] Between the end of one exposure and the start of the next."""
_LEAST_STEP = 0.3  # [stop] by which exposures differ that are meant to differ
_LEAST_ALIKE = 0.85  # rank correlation of code values; a response does not change ranks
_FEWEST_POINTS = 60


@dataclass(frozen=True, slots=True, eq=False)
class Exposure:
    """One photo that may belong to a bracket."""

    name: str
    sha256: str
    shot: Shot
    samples: bytes

    @property
    def stops(self) -> float:
        """log2 of the exposure, by time, f-number and sensitivity."""
        aperture, iso = self.shot.aperture or 1.0, self.shot.iso or 1.0
        return log2(self.shot.exposure_s * iso / aperture**2)


def find_brackets(exposures: Iterable[Exposure]) -> Iterator[tuple[Exposure, ...]]:
    """Yield the brackets of a camera, of two photos or more.

    Parameters
    ----------
    exposures
        In the order of their times; each has a time and an exposure time.
    """
    series: list[Exposure] = []
    for one in exposures:
        if series and one.sha256 == series[-1].sha256:
            continue
        if series and not _goes_on(series, one):
            if len(series) > 1:
                yield tuple(series)
            series = []
        series.append(one)
    if len(series) > 1:
        yield tuple(series)


def _goes_on(series: list[Exposure], one: Exposure) -> bool:
    last = series[-1]
    pause = one.shot.taken - last.shot.taken - last.shot.exposure_s
    known = [(e.shot.aperture > 0.0, e.shot.iso > 0.0) for e in (last, one)]
    differs = all(abs(one.stops - other.stops) >= _LEAST_STEP for other in series)
    return pause <= SECONDS and known[0] == known[1] and differs and _same_scene(last, one)


def _same_scene(one: Exposure, other: Exposure) -> bool:
    """Whether two photos have the same picture up to exposure, and the longer is the brighter."""
    first, second = (_green(e.samples) for e in (one, other))
    brighter = float(second.mean()) - float(first.mean())
    if brighter * (other.stops - one.stops) <= 0.0:
        return False
    clear = (first >= LOWEST) & (first <= HIGHEST) & (second >= LOWEST) & (second <= HIGHEST)
    first, second = first[clear], second[clear]
    if len(first) < _FEWEST_POINTS or np.ptp(first) == 0 or np.ptp(second) == 0:
        return False
    return float(spearmanr(first, second).statistic) >= _LEAST_ALIKE


def _green(samples: bytes) -> Samples:
    return read_samples(samples)[:, 1]
