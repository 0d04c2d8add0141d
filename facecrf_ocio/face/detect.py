"""Every face of a photo that is large enough to be measured, and the ladder when none is found."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.face.blazeface import detect_blazeface
from facecrf_ocio.face.candidate import Candidate, drop_duplicates, is_same
from facecrf_ocio.face.landmarks import fit_landmarks
from facecrf_ocio.face.pyramid import Pyramid
from facecrf_ocio.face.tone import Tone, brightening_tone
from facecrf_ocio.face.yunet import detect_yunet
from facecrf_ocio.photo.raster.pixels import Pixels, code_values
from facecrf_ocio.settings import FaceSettings
from facecrf_ocio.values import Face, Float

# A face this wide [px] on the half-size copy is the one that counts: any that only the full-size
# copy would show is less than half as wide.
_WIDE_ENOUGH = 40
# [px] of the quarter-size copy, a fifth of it: a face too large for the detector to see it on the
# half-size copy. It, too, ends the search, before the full-size copy, where it cannot be seen.
_FILLS_MUCH = 60
# A single face that the quarter-size copy shows surely is sought on the half-size copy around it
# alone: from where it has so many pixels on, no face was seen on that copy, which holds up to 360.
_BEYOND_HALF = 400
# [px] of the half-size copy: how much of it is searched around such a face on each side, and at
# least in all, since the detector sees a face by what is around it.
_AROUND, _LEAST_PART = 96, 384
_CELL = 32  # [px] the detector's coarsest grid, on which the part begins
_DOUBTFUL_SCORE = 0.5  # of the widest that the quarter-size copy shows, sure or not
# A second look meets mostly photos without a face, so it must be surer than the first.
_RETRY_SCORE = 0.8
_RETRY_BLAZEFACE_SCORE = 0.65  # on clear faces YuNet says 0.9 and BlazeFace 0.7 to 0.9
_RETRY_WIDTH = 40  # [px of the photo]
_TURNS = (90, 270, 180, 45, 315, 135, 225)  # [degree]


@dataclass(frozen=True, slots=True, eq=False)
class FoundFaces:
    """The faces of one photo.

    Attributes
    ----------
    faces
        Those at least `FaceSettings.min_face_width` wide, widest first.
    too_small
        How many narrower ones a detector saw. If `faces` is empty, this tells "no face" from "no
        face large enough".
    turned_away
        If there is neither, in how many places large enough a detector surely saw a face, and the
        landmark network none: in profile, covered, bent down or blurred.
    """

    faces: tuple[Face, ...]
    too_small: int
    turned_away: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class _Look:
    """What one search gave, in pixels of the photo."""

    candidates: tuple[Candidate, ...]
    tone: Tone | None
    turned: bool = False


def find_faces(pixels: Pixels, settings: FaceSettings, most: int | None = None) -> FoundFaces:
    """Find all faces of a photo, or the widest ones.

    YuNet looks first. If it sees nothing, further looks follow until one succeeds: at a brightened
    copy if the photo is dark, at a smaller copy, with BlazeFace, and at the copy turned by
    multiples of 45 degrees; these must be surer (YuNet 0.8, BlazeFace 0.65) and ignore all that is
    narrower than 40 px. A face counts only if the landmark network, too, sees one there.

    Parameters
    ----------
    pixels
        (H, W, 3) RGB in [0, 1], or in 8 bits.
    settings
        `detection_long_side`, `min_face_score` and `min_face_width` (in pixels of the photo).
    most
        As many faces as are wanted; no landmarks are fitted to narrower ones. All by default. A
        single one is sought on the smallest copy first, and where it is seen there.
    """
    side = settings.detection_long_side
    pyramid = Pyramid(pixels, side, max(1, side // 2), max(1, side // 4))
    if most == 1:
        candidate = _widest_soon(pyramid, settings)
        face = None if candidate is None else _fit(pyramid, candidate, _Look((candidate,), None))
        if face is not None:
            return FoundFaces((face,), 0)
    turned_away = 0
    for look in _looks(pyramid, settings):
        found = _examine(pyramid, look, settings.min_face_width, most)
        if found.faces or found.too_small:
            return found
        turned_away = max(turned_away, found.turned_away)
    return FoundFaces((), 0, turned_away)


def _examine(pyramid: Pyramid, look: _Look, min_width: float, most: int | None) -> FoundFaces:
    """Fit landmarks to the candidates that are large enough and keep those that are faces."""
    widest_first = sorted(look.candidates, key=lambda item: item.width, reverse=True)
    large = [candidate for candidate in widest_first if candidate.width >= min_width]
    small = widest_first[len(large) :]
    fitted = (_fit(pyramid, candidate, look) for candidate in large)
    faces = tuple(islice((face for face in fitted if face is not None), most))
    # What is too small needs no landmarks, but must not end the search if it is no face.
    if not faces and small and _fit(pyramid, small[0], look) is None:
        small = []
    if faces or small:
        return FoundFaces(faces, len(small))
    return FoundFaces((), 0, sum(candidate.score >= _RETRY_SCORE for candidate in large))


def _fit(pyramid: Pyramid, candidate: Candidate, look: _Look) -> Face | None:
    """Fit landmarks; None if their network sees no face."""
    landmarks = fit_landmarks(pyramid, candidate, look.tone)
    if landmarks is None:
        return None
    box = _box_around(landmarks.xyz) if look.turned else _box(candidate)
    return Face(box, landmarks.xyz, candidate.score)


def _looks(pyramid: Pyramid, settings: FaceSettings) -> Iterator[_Look]:
    """Search after search, each made only when it is asked for."""
    full = pyramid.level_within(settings.detection_long_side)
    half = pyramid.level_within(settings.detection_long_side // 2)
    yield _Look(_search(pyramid, (half, full), None, settings.min_face_score), None)

    score = max(settings.min_face_score, _RETRY_SCORE)
    tone = brightening_tone(code_values(pyramid.level(len(pyramid) - 1), 8))
    if tone is not None:
        yield _Look(_wide(_search(pyramid, (half, full), tone, score)), tone)
    yield _Look(_wide(_search_level(pyramid, len(pyramid) - 1, tone, score)), tone)

    pixels = _eight_bit(pyramid.level(half), tone)
    seen = detect_blazeface(pixels, _RETRY_BLAZEFACE_SCORE)
    yield _Look(_wide(_to_photo(pyramid, half, seen)), tone)
    for degrees in _TURNS:
        turned, to_upright = _turn(pixels, degrees)
        seen = tuple(item.transform(to_upright) for item in detect_yunet(turned, score))
        yield _Look(_wide(_to_photo(pyramid, half, seen)), tone, turned=True)


def _widest_soon(pyramid: Pyramid, settings: FaceSettings) -> Candidate | None:
    """The widest face if the smallest copy shows it surely, as the first search would find it.

    In half of its time, since little of the half-size copy is looked at. None sends it there.
    """
    half, last = pyramid.level_within(settings.detection_long_side // 2), len(pyramid) - 1
    if half == last:
        return None
    doubtful = min(_DOUBTFUL_SCORE, settings.min_face_score)
    seen = _search_level(pyramid, last, None, doubtful)
    widest = max(seen, key=lambda candidate: candidate.width, default=None)
    sure = max(settings.min_face_score, _RETRY_SCORE)
    scale_xy = pyramid.scale_xy(half)
    if widest is None or widest.score < sure:
        return None
    width = widest.width * scale_xy[0]
    if width < max(_WIDE_ENOUGH, settings.min_face_width * scale_xy[0]):
        return None
    return widest if width >= _BEYOND_HALF else _near(pyramid, half, widest, settings)


def _near(
    pyramid: Pyramid, level: int, known: Candidate, settings: FaceSettings
) -> Candidate | None:
    """The face that a level shows where another one shows it."""
    pixels, scale_xy = pyramid.level(level), pyramid.scale_xy(level)
    center, size = known.center_xy * scale_xy, known.size_xy * scale_xy
    half = np.maximum(size / 2 + _AROUND, _LEAST_PART / 2)
    low, high = center - half, center + half
    left, top = (np.maximum(np.floor(low / _CELL), 0).astype(int) * _CELL).tolist()
    right, bottom = (np.ceil(high / _CELL).astype(int) * _CELL).tolist()
    part = _eight_bit(pixels[top:bottom, left:right], None)
    to_level = np.array([[1.0, 0.0, left], [0.0, 1.0, top]])
    found = [one.transform(to_level) for one in detect_yunet(part, settings.min_face_score)]
    same = [one for one in _to_photo(pyramid, level, tuple(found)) if is_same(one, known)]
    return max(same, key=lambda candidate: candidate.width, default=None)


def _search(
    pyramid: Pyramid, levels: tuple[int, int], tone: Tone | None, min_score: float
) -> tuple[Candidate, ...]:
    """Search the half-size copy and, unless a face fills much of it, the full-size copy too."""
    half, full = levels
    seen = _search_level(pyramid, half, tone, min_score)
    wide_enough = _WIDE_ENOUGH / pyramid.scale_xy(half)[0]
    if full == half or any(candidate.width >= wide_enough for candidate in seen):
        return seen
    last = len(pyramid) - 1
    large = _search_level(pyramid, last, tone, max(min_score, _RETRY_SCORE))
    large = _wide(large, _FILLS_MUCH / pyramid.scale_xy(last)[0])
    if large:
        return large
    return drop_duplicates((*seen, *_search_level(pyramid, full, tone, min_score)))


def _search_level(
    pyramid: Pyramid, level: int, tone: Tone | None, min_score: float
) -> tuple[Candidate, ...]:
    pixels = _eight_bit(pyramid.level(level), tone)
    return _to_photo(pyramid, level, detect_yunet(pixels, min_score))


def _to_photo(
    pyramid: Pyramid, level: int, candidates: tuple[Candidate, ...]
) -> tuple[Candidate, ...]:
    x, y = 1.0 / pyramid.scale_xy(level)
    to_photo = np.array([[x, 0.0, 0.0], [0.0, y, 0.0]])
    return tuple(candidate.transform(to_photo) for candidate in candidates)


def _wide(
    candidates: tuple[Candidate, ...], at_least: float = _RETRY_WIDTH
) -> tuple[Candidate, ...]:
    return tuple(candidate for candidate in candidates if candidate.width >= at_least)


def _eight_bit(level: Pixels, tone: Tone | None) -> npt.NDArray[np.uint8]:
    if level.dtype == np.uint8 and tone is None:
        return level
    encoded = code_values(level, 8)
    encoded = encoded if tone is None else tone.apply(encoded)
    codes = np.clip(encoded, 0.0, 1.0)
    codes *= np.float32(255)  # in one array: several take three times as long
    codes += np.float32(0.5)
    return codes.astype(np.uint8)


def _turn(pixels: npt.NDArray[np.uint8], degrees: float) -> tuple[npt.NDArray[np.uint8], Float]:
    """Turn an image about its center onto a canvas that holds it, and say how to turn back.

    Returns
    -------
    turned
        (H', W', 3).
    to_upright
        (2, 3) rotation from pixels of `turned` to pixels of the image.
    """
    height, width = pixels.shape[:2]
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    rotation = np.array([[cosine, -sine], [sine, cosine]])
    canvas = np.rint(np.abs(rotation) @ [width, height])
    shift = np.array([width, height]) / 2 - rotation @ (canvas / 2)
    to_upright = np.column_stack([rotation, shift])
    opencv = to_upright.copy()  # OpenCV counts from the center of the first pixel
    opencv[:, 2] += rotation @ np.full(2, 0.5) - 0.5
    turned = cv2.warpAffine(
        pixels,
        opencv,
        (int(canvas[0]), int(canvas[1])),
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_REPLICATE,
    )
    return np.asarray(turned, dtype=np.uint8), to_upright


def _box(candidate: Candidate) -> Float:
    return np.concatenate([candidate.center_xy - candidate.size_xy / 2, candidate.size_xy])


def _box_around(landmarks: Float) -> Float:
    low, high = landmarks[:, :2].min(axis=0), landmarks[:, :2].max(axis=0)
    return np.concatenate([low, high - low])
