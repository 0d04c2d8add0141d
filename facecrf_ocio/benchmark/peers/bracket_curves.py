"""Curves from brackets of synthetic scenes: ours, OpenCV's, colour-hdri's, and trivial answers."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import cv2
import numpy as np

from facecrf_ocio.benchmark.peers.merge_errors import STOPS, scene, shots
from facecrf_ocio.benchmark.peers.peer_table import Answer, as_curve, peer, trivial
from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.pair.calibrate_bracket import calibrate_bracket
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.values import Float, InverseCRF, Photo

_LARGER = 3  # than the scenes of the merges: 720 px, so that patches of 5 px are flat
_SAMPLES = 200  # of colour-hdri: its 1,000 take it minutes, and change less than a tenth
_LEVELS = np.linspace(0.0, 1.0, 256)  # the codes of 8 bits


class Brackets:
    """A bracket of a still scene for each curve, with exposures that are known exactly."""

    def __init__(self, truths: Sequence[InverseCRF]) -> None:
        self.truths = tuple(truths)
        self.photos = lru_cache(maxsize=1)(self._photos)

    def _photos(self, case: int) -> list[Photo]:
        return shots([scene(case, _LARGER)] * len(STOPS), case, self.truths[case])

    def answers(self) -> dict[str, Answer]:
        """Who is asked, in the order of the table."""
        mean = dorf_model()
        return {
            "`facecrf bracket`": self.ours,
            "OpenCV CalibrateDebevec": lambda case: self.opencv("Debevec", case),
            "OpenCV CalibrateRobertson": lambda case: self.opencv("Robertson", case),
            "colour-hdri, Debevec (1997)": self.colour_hdri,
            "mean curve, without the photos": trivial(lambda g: np.interp(g, mean.grid, mean.mean)),
            "sRGB, without the photos": trivial(decode_srgb),
        }

    def ours(self, case: int) -> InverseCRF | None:
        """As `facecrf bracket` does it."""
        return calibrate_bracket(self.photos(case), STOPS).estimate.found

    def opencv(self, kind: str, case: int) -> InverseCRF:
        """`CalibrateDebevec` or `CalibrateRobertson`, as they are made."""
        images = [np.rint(photo.encoded * 255).astype(np.uint8) for photo in self.photos(case)]
        times = np.exp2(STOPS).astype(np.float32)
        found = getattr(cv2, f"createCalibrate{kind}")().process(images, times)
        return as_curve(_LEVELS, np.asarray(found, np.float64)[:, 0].T)

    def colour_hdri(self, case: int) -> InverseCRF:
        """`camera_response_functions_Debevec1997` with its default weights."""
        hdri = peer("colour_hdri", "colour-hdri")
        stack = hdri.ImageStack()
        for photo, stop in zip(self.photos(case), STOPS, strict=True):
            told = hdri.Metadata(f_number=1.0, exposure_time=float(2.0**stop), iso=100.0)
            stack.append(hdri.Image(data=photo.encoded.astype(np.float64), metadata=told))
        few = {"samples": _SAMPLES}
        solved = hdri.camera_response_functions_Debevec1997(stack, sampling_function_kwargs=few)
        found: Float = np.asarray(solved)
        return as_curve(np.linspace(0.0, 1.0, len(found)), found.T)
