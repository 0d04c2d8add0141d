"""What a face detector answers, before anything else has looked at it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from facecrf_ocio.values import Float, frozen


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A place where a detector sees a face.

    Attributes
    ----------
    center_xy
        (2,) pixels.
    size_xy
        (2,) width and height in pixels along the axes of the image that was searched.
    eyes_xy
        (2, 2) pixels; the eye on the left of an upright photo first.
    score
        In [0, 1].
    """

    center_xy: Float
    size_xy: Float
    eyes_xy: Float
    score: float

    def __post_init__(self) -> None:
        for name in ("center_xy", "size_xy", "eyes_xy"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    @property
    def width(self) -> float:
        """Width of the face in pixels."""
        return float(self.size_xy[0])

    def transform(self, matrix: Float) -> Candidate:
        """Return the candidate moved by a (2, 3) similarity; the size is scaled, not turned."""
        scale = float(np.hypot(*matrix[:, 0]))
        return Candidate(
            center_xy=matrix[:, :2] @ self.center_xy + matrix[:, 2],
            size_xy=self.size_xy * scale,
            eyes_xy=self.eyes_xy @ matrix[:, :2].T + matrix[:, 2],
            score=self.score,
        )


def drop_duplicates(candidates: Iterable[Candidate]) -> tuple[Candidate, ...]:
    """Keep the best of all candidates that are the same face, best first."""
    kept: list[Candidate] = []
    for candidate in sorted(candidates, key=lambda item: item.score, reverse=True):
        if not any(is_same(candidate, other) for other in kept):
            kept.append(candidate)
    return tuple(kept)


def is_same(a: Candidate, b: Candidate) -> bool:
    """Whether two boxes are of one face: they overlap by more than 30 %."""
    return _overlap(a, b) > 0.3


def _overlap(a: Candidate, b: Candidate) -> float:
    """Intersection over union."""
    low = np.maximum(a.center_xy - a.size_xy / 2, b.center_xy - b.size_xy / 2)
    high = np.minimum(a.center_xy + a.size_xy / 2, b.center_xy + b.size_xy / 2)
    shared = float(np.prod(np.maximum(high - low, 0.0)))
    return shared / float(np.prod(a.size_xy) + np.prod(b.size_xy) - shared)
