"""Which frames of a clip are used: in each stretch of time the one with the best face."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.clip.frame_list import Clip
from facecrf_ocio.clip.tracked_points import shrunk
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.joint import JointModel, PhotoEvidence, gather
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Face, Float, Photo

_TRIED = 3  # frames looked at for each that is used
_FEWEST_READ = 2  # of them: one frame is no clip


@dataclass(frozen=True, slots=True, eq=False)
class ChosenFrame:
    """A frame that tells something.

    Attributes
    ----------
    index
        In the clip.
    evidence
        What it says of the curve.
    face_codes
        (N, 3) encoded values within the face's box.
    small
        (h, w, 3) the frame at the size at which points are followed.
    path
        Its file.
    thumbnail
        (576,) brightness ranks of 32 x 18 pixels, by which cuts are found.
    """

    index: int
    evidence: PhotoEvidence
    face_codes: Float
    small: npt.NDArray[np.float32]
    path: Path | None
    thumbnail: Float


def choose_frames(
    clip: Clip, frames: int, settings: Settings | None, model: JointModel
) -> list[ChosenFrame]:
    """The frame of each stretch of time whose face is largest and sharpest.

    Raises
    ------
    PhotoError
        If fewer than two of those that are looked at can be read.
    """
    count = len(clip.times)
    tried = np.unique(np.linspace(0, count - 1, min(count, _TRIED * frames)).astype(np.intp))
    found = []
    for _, stretch in groupby(clip.read(tried.tolist()), lambda one: one[0] * frames // count):
        best: tuple[float, int, Photo] | None = None  # others are let go as they come
        for index, photo in stretch:
            worth = _worth(photo, settings)
            if worth > 0.0 and (best is None or worth > best[0]):
                best = (worth, index, photo)
        one = None if best is None else _looked_at(best[1], best[2], settings, model)
        found += [] if one is None else [one]
    if sum(index not in clip.unread for index in tried.tolist()) < _FEWEST_READ:
        raise next(iter(clip.unread.values()))
    return found


def _worth(photo: Photo, settings: Settings | None) -> float:
    """Width of the largest face times its sharpness; 0 without a face."""
    faces = find_faces(photo.pixels, settings or Settings(), most=1).faces
    if not faces:
        return 0.0
    inside = _inside(photo, faces[0])
    if min(inside.shape[:2]) < 2:
        return 0.0
    gray = cv2.cvtColor(np.ascontiguousarray(inside), cv2.COLOR_RGB2GRAY)
    return float(inside.shape[1] * np.std(cv2.Laplacian(gray, cv2.CV_32F)) + 1e-9)


def _inside(photo: Photo, face: Face) -> npt.NDArray[np.float32]:
    x, y, width, height = (round(float(v)) for v in face.box_xy)
    return photo.encoded[max(y, 0) : y + height, max(x, 0) : x + width]


def _looked_at(
    index: int, photo: Photo, settings: Settings | None, model: JointModel
) -> ChosenFrame | None:
    evidence = gather(photo, settings, model.networks)
    if evidence.face is None or not evidence.messages:
        return None
    codes = _inside(photo, evidence.face).reshape(-1, 3).astype(np.float64)
    thumbnail = cv2.resize(photo.encoded, (32, 18), interpolation=cv2.INTER_AREA).mean(axis=2)
    ranks = np.argsort(np.argsort(thumbnail.ravel())).astype(np.float64)
    return ChosenFrame(index, evidence, codes, shrunk(photo.encoded), photo.path, ranks)
