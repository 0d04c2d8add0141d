"""YuNet, the first detector: fast, and sure of upright faces from 15 to 300 pixels wide."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.face.candidate import Candidate
from facecrf_ocio.face.networks import model_file

_LOCK = threading.Lock()  # the detector's input size is part of its state
_SMALLEST_SIDE = 16  # [px] below it no face can be seen and OpenCV may refuse the image


def detect_yunet(pixels: npt.NDArray[np.uint8], min_score: float) -> tuple[Candidate, ...]:
    """Find upright faces.

    Parameters
    ----------
    pixels
        (H, W, 3) RGB.
    min_score
        Faces of lower score are left out, [0, 1].
    """
    height, width = pixels.shape[:2]
    if min(height, width) < _SMALLEST_SIDE:
        return ()
    with _LOCK:
        detector = yunet_detector()
        detector.setInputSize((width, height))
        detector.setScoreThreshold(min_score)
        rows = detector.detect(cv2.cvtColor(pixels, cv2.COLOR_RGB2BGR))[1]
    return tuple(_candidate(row) for row in ([] if rows is None else rows) if (row[2:4] > 0).all())


def _candidate(row: npt.NDArray[np.float32]) -> Candidate:
    """(15,): x, y, width, height, then x, y of eyes, nose and mouth corners, then the score."""
    return Candidate(
        center_xy=row[:2] + row[2:4] / 2,
        size_xy=row[2:4],
        eyes_xy=row[4:8].reshape(2, 2),
        score=float(row[14]),
    )


@cache
def yunet_detector() -> Any:
    """OpenCV's detector, made once per process."""
    with model_file("face_detection_yunet_2023mar.onnx") as path, _without_warnings():
        return cv2.FaceDetectorYN.create(str(path), "", (320, 320))


@contextmanager
def _without_warnings() -> Iterator[None]:
    """OpenCV 5 warns on every load that it ignores a choice of device which nobody made."""
    logging: Any = getattr(cv2.utils, "logging", None)
    if logging is None:
        yield
        return
    level = logging.getLogLevel()
    logging.setLogLevel(min(level, logging.LOG_LEVEL_ERROR))
    try:
        yield
    finally:
        logging.setLogLevel(level)
