"""Curves from drawn photos of a color chart: ours, chromacal's, and trivial answers."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.peers.drawn_chart import lit_chart, shot
from facecrf_ocio.benchmark.peers.peer_table import Answer, as_curve, peer, trivial
from facecrf_ocio.chart.calibrate_chart import calibrate_chart
from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.values import Float, InverseCRF, Photo

_FALL = 0.6  # [stop] of the light across the picture
_TURN = 10.0  # [degree]


class Charts:
    """A photo of a chart for each curve: in perspective, turned, in uneven light, as JPEG 92."""

    def __init__(self, truths: Sequence[InverseCRF]) -> None:
        self.truths = tuple(truths)
        self.photo = lru_cache(maxsize=1)(self._photo)

    def _photo(self, case: int) -> tuple[Photo, Float]:
        light, corners = lit_chart(case, white=0.8, fall=_FALL, turn=_TURN)
        return shot(light, self.truths[case], seed=case)[1], corners

    def answers(self) -> dict[str, Answer]:
        """Who is asked, in the order of the table."""
        mean = dorf_model()
        return {
            "`facecrf chart`": self.ours,
            "chromacal": self.chromacal,
            "mean curve, without the photo": trivial(lambda g: np.interp(g, mean.grid, mean.mean)),
            "sRGB, without the photo": trivial(decode_srgb),
        }

    def ours(self, case: int) -> InverseCRF | None:
        """As `facecrf chart --corners` does it."""
        photo, corners = self.photo(case)
        return calibrate_chart(photo, corners).estimate.found

    def chromacal(self, case: int) -> InverseCRF | None:
        """Detected and solved by chromacal; its matrix scales the channels of a gray, no more."""
        chromacal = peer("chromacal", "chromacal")
        codes = np.rint(self.photo(case)[0].encoded * 255).astype(np.uint8)
        grays = np.repeat(np.linspace(0.0, 1.0, 256)[None, :, None], 3, axis=2)
        with _silence():
            patches = chromacal.detect(np.ascontiguousarray(codes[..., ::-1]))
            if not len(patches):
                return None
            solver = chromacal.Solver()
            solver.solve(patches)
            found = np.asarray(solver.infer(grays))[0]
        return as_curve(grays[0, :, 0], found.T)


@contextmanager
def _silence() -> Iterator[None]:
    """Keep what a native library prints from stdout, on which the table is told."""
    sys.stdout.flush()
    kept = os.dup(1)
    try:
        with Path(os.devnull).open("wb") as nowhere:
            os.dup2(nowhere.fileno(), 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
