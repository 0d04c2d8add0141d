"""BlazeFace (full range), the second detector: it sees some faces that YuNet does not."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.face.candidate import Candidate, drop_duplicates
from facecrf_ocio.face.networks import load_network
from facecrf_ocio.values import Float

_SIDE = 192  # [px] of the square input
_CELLS = 48  # anchors along each side, one at the center of each cell


def detect_blazeface(pixels: npt.NDArray[np.uint8], min_score: float) -> tuple[Candidate, ...]:
    """Find upright faces wider than about a tenth of the image's longer side.

    Parameters
    ----------
    pixels
        (H, W, 3) RGB.
    min_score
        Faces of lower score are left out, [0, 1].
    """
    square, scale = _fit_into_square(pixels)
    network = load_network(
        "face_detection_full_range.tflite",
        "reshaped_classifier_face_4",
        "reshaped_regressor_face_4",
    )
    logits, boxes = network.run(square)
    return tuple(
        candidate.transform(np.array([[1.0 / scale, 0.0, 0.0], [0.0, 1.0 / scale, 0.0]]))
        for candidate in drop_duplicates(_decode(logits.ravel(), boxes[0], min_score))
    )


def _fit_into_square(pixels: npt.NDArray[np.uint8]) -> tuple[npt.NDArray[np.float32], float]:
    """The image at the top left of (192, 192, 3), black around, from -1 to 1; and its scale."""
    height, width = pixels.shape[:2]
    scale = _SIDE / max(height, width)
    size = (max(1, round(width * scale)), max(1, round(height * scale)))
    square = np.zeros((_SIDE, _SIDE, 3), np.uint8)
    shrinking = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_LINEAR
    square[: size[1], : size[0]] = cv2.resize(pixels, size, interpolation=shrinking)
    return square.astype(np.float32) / 127.5 - 1.0, scale


def _decode(logits: Float, boxes: Float, min_score: float) -> list[Candidate]:
    """Candidates of logits (2304,) and boxes (2304, 16).

    A box is center, width, height and six key points in pixels, relative to its anchor.
    """
    scores = 1.0 / (1.0 + np.exp(-np.clip(logits, -60.0, 60.0)))
    result = []
    for index in np.flatnonzero(scores >= min_score):
        anchor = (np.array([index % _CELLS, index // _CELLS]) + 0.5) * (_SIDE / _CELLS)
        box = boxes[index].reshape(8, 2).astype(np.float64)
        if (box[1] > 0).all():
            result.append(
                Candidate(box[0] + anchor, box[1], box[2:4] + anchor, float(scores[index]))
            )
    return result
