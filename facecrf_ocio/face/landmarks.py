"""Dense landmarks: 478 points in 3-D on a face that a detector found."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.face.candidate import Candidate
from facecrf_ocio.face.networks import Network, load_network
from facecrf_ocio.face.pyramid import Pyramid
from facecrf_ocio.face.tone import Tone
from facecrf_ocio.photo.raster.pixels import Pixels, code_values
from facecrf_ocio.values import Float

_SIDE = 256  # [px] of the network's square input
_MARGIN = 1.5  # side of the crop over the longer side of the face, as the network was trained
_OUTER_EYE_CORNERS = [33, 263]  # vertices of the mesh, the right eye's first
# Each crop is placed by the landmarks of the one before, until they stay where they are. Measured
# on faces turned by all angles: upright ones settle in two passes to 1 % of the face's size, with a
# presence of 13 to 27 (8 and more where half hidden, tiny or blurred); a face fitted upside down
# mostly does not settle, or has less than 13: of 91 faces begun at each wrong quarter turn, 19 fits
# settled there, with 11.3 at most.
_MOST_PASSES = 4
_SETTLED = 0.03  # of the face's size, from pass to pass
_LEAST_PRESENCE = 5.0  # [logit]
_SURE_PRESENCE = 13.0  # [logit] from which no other roll is tried
_CLEARLY_BETTER = 5.0  # what another roll must gain before the detector's is given up
_OTHER_QUARTER_TURNS = (2, 1, 3)  # upside down first, which is the commonest mistake
_QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])  # (2, 2) rotation


@dataclass(frozen=True, slots=True, eq=False)
class Landmarks:
    """Landmarks of one face.

    Attributes
    ----------
    xyz
        (478, 3) pixels of the photo, as in `Face`.
    presence
        The network's belief that there is a face at all, as a logit.
    """

    xyz: Float
    presence: float


def fit_landmarks(
    pyramid: Pyramid, candidate: Candidate, tone: Tone | None = None
) -> Landmarks | None:
    """Fit landmarks to the face at a candidate's place, whatever its roll.

    Detectors see faces that lie or stand on their head, but then mistake chin for forehead, so a
    fit that is not sure is tried again at the other three quarter turns.

    Parameters
    ----------
    pyramid
        The photo.
    candidate
        The face, in pixels of the photo.
    tone
        Brightens the crop before the network sees it.

    Returns
    -------
    Landmarks or None
        None if the network sees no face, or its landmarks do not settle.
    """
    best = _fit_from(pyramid, candidate, 0, tone, -np.inf)
    if best is not None and best.presence >= _SURE_PRESENCE:
        return best
    required = _LEAST_PRESENCE if best is None else best.presence + _CLEARLY_BETTER
    for turns in _OTHER_QUARTER_TURNS:
        other = _fit_from(pyramid, candidate, turns, tone, required)
        if other is not None and other.presence >= required:
            best, required = other, other.presence
    return best


def _fit_from(
    pyramid: Pyramid, candidate: Candidate, quarter_turns: int, tone: Tone | None, required: float
) -> Landmarks | None:
    """Fit from the detector's roll and so many quarter turns.

    None if there is no face this way, or if by the second pass its presence is not what is required
    of it: of 80 faces turned by 90 and 180 degrees none took longer at its own turn.
    """
    center, longest = candidate.center_xy, float(candidate.size_xy.max())
    rotation = _roll(candidate.eyes_xy) @ np.linalg.matrix_power(_QUARTER_TURN, quarter_turns)
    before: Float | None = None
    for number in range(_MOST_PASSES):
        to_photo = _crop_to_photo(center, _MARGIN * longest, rotation)
        crop = _crop(pyramid, to_photo)
        landmarks, presence = _run(crop if tone is None else tone.apply(crop))
        if number == 1 and presence < required:
            return None
        landmarks = _to_photo(landmarks, to_photo)
        rotation = _roll(landmarks[_OUTER_EYE_CORNERS, :2])
        center, longest = _bounding_square(landmarks[:, :2], rotation)
        if before is not None and _mean_distance(landmarks, before) < _SETTLED * longest:
            return Landmarks(landmarks, presence) if presence >= _LEAST_PRESENCE else None
        before = landmarks
    return None


def _mean_distance(a: Float, b: Float) -> float:
    return float(np.linalg.norm(a - b, axis=1).mean())


def _crop_to_photo(center: Float, side: float, rotation: Float) -> Float:
    """(2, 3) similarity from crop to photo."""
    scaled = rotation * (side / _SIDE)
    return np.column_stack([scaled, center - scaled @ np.full(2, _SIDE / 2)])


def _roll(eyes: Float) -> Float:
    """(2, 2) rotation that takes the x axis to the line through both eyes."""
    x, y = eyes[1] - eyes[0]
    length = float(np.hypot(x, y))
    cosine, sine = (x / length, y / length) if length > 0.0 else (1.0, 0.0)
    return np.array([[cosine, -sine], [sine, cosine]])


def _bounding_square(points: Float, rotation: Float) -> tuple[Float, float]:
    """Center (2,) and longer side of the turned box around points (N, 2)."""
    aligned = points @ rotation
    low, high = aligned.min(axis=0), aligned.max(axis=0)
    return rotation @ ((low + high) / 2), float((high - low).max())


def _crop(pyramid: Pyramid, to_photo: Float) -> npt.NDArray[np.float32]:
    pixels, scale_xy = pyramid.level_for(float(np.hypot(*to_photo[:, 0])))
    to_level = to_photo * scale_xy[:, None]
    # OpenCV counts from the center of the first pixel, we from its corner.
    to_level[:, 2] += to_level[:, :2] @ np.full(2, 0.5) - 0.5
    part, corner = _around(pixels, to_level)
    to_level[:, 2] -= corner
    crop = cv2.warpAffine(
        part,
        to_level,
        (_SIDE, _SIDE),
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_REPLICATE,
    )
    return np.asarray(np.clip(crop, 0.0, 1.0), dtype=np.float32)


def _around(pixels: Pixels, to_level: Float) -> tuple[npt.NDArray[np.float32], Float]:
    """The part of an image that a crop is taken from, as encoded values, and its corner (2,)."""
    corners = to_level @ np.array([[0, _SIDE, 0, _SIDE], [0, 0, _SIDE, _SIDE], [1, 1, 1, 1]])
    last = np.array(pixels.shape[1::-1]) - 1
    low = np.clip(np.floor(corners.min(axis=1)) - 2, 0, last).astype(int)
    high = np.clip(np.ceil(corners.max(axis=1)) + 2, low, last).astype(int)
    part = pixels[low[1] : high[1] + 1, low[0] : high[0] + 1]
    return code_values(part, 8), low


def landmark_network() -> Network:
    """The network that finds landmarks, read from disk once per process."""
    return load_network("face_landmarks_detector.tflite", "Identity", "Identity_1")


def _run(crop: npt.NDArray[np.float32]) -> tuple[Float, float]:
    landmarks, presence = landmark_network().run(crop)
    return landmarks.reshape(478, 3).astype(np.float64), float(presence.ravel()[0])


def _to_photo(landmarks: Float, to_photo: Float) -> Float:
    """Move x and y of landmarks (N, 3) by the similarity (2, 3), and give z its scale."""
    xy = landmarks[:, :2] @ to_photo[:, :2].T + to_photo[:, 2]
    return np.column_stack([xy, landmarks[:, 2] * np.hypot(*to_photo[:, 0])])
