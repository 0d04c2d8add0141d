"""Photos of linear heads through drawn responses, reduced to the statistics that are learned from.

A head is detected and its mesh is laid once; every draw then encodes it anew.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.face.view import FaceView, cut_face
from facecrf_ocio.joint.statistics import face_statistics, photo_statistics
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.settings import Settings
from facecrf_ocio.training.curves import NO_ROW, CurveSource
from facecrf_ocio.training.variation import process, vary
from facecrf_ocio.values import Float, Photo

_LEVELS = 16384
_SIZES = (0.6, 1.5)
_SIZE_ODDS = (0.6, 0.25, 0.15)
_MEASURED_SHARE = 3  # one photo in so many is encoded by a measured response, without variation


@dataclass(frozen=True, slots=True, eq=False)
class Example:
    """What one simulated photo shows, and the response behind it.

    Attributes
    ----------
    head
        Name of the image.
    family
        Index into `joint.prior.FAMILIES`.
    row
        Of the measured response it comes from.
    measured
        True if the response is a measured one and the photo was not varied.
    inverse
        (1024,) the truth.
    by_cue
        Statistics of each cue.
    mixed_with
        Row of a second measured response in it, else `NO_ROW`.
    """

    head: str
    family: int
    row: int
    measured: bool
    inverse: npt.NDArray[np.float32]
    by_cue: dict[str, Float]
    mixed_with: int = NO_ROW


def simulate(path: Path, source: CurveSource, count: int, seed: int) -> Iterator[Example]:
    """Photograph one linear head with `count` cameras.

    Parameters
    ----------
    path
        Linear image with a face.
    source
        Responses to draw from.
    count, seed
        Number of photos; of the draws, so that each head has its own.

    Raises
    ------
    PhotoError
        If no face is found.
    """
    settings = Settings()
    linear = np.clip(read_photo(path).encoded, 0.0, 1.0)
    stands = _stands(path, linear, settings)
    generator = np.random.default_rng([seed, *path.name.encode()])
    for number in range(count):
        measured = number % _MEASURED_SHARE == 0
        drawn = source.draw(generator, measured=measured)
        stand = stands[0]
        if not measured:
            size = int(generator.choice(len(_SIZE_ODDS), p=_SIZE_ODDS))
            stand = stands[min(size, len(stands) - 1)]
        light = stand.linear if measured else vary(stand.linear, generator)
        encoded = _encode(light, drawn.inverse)
        if not measured:
            encoded = process(encoded, generator)
        by_cue = dict(photo_statistics(encoded if measured else _frame(encoded, stand, generator)))
        of_face = face_statistics(_look_again(stand, encoded), settings)
        if of_face is not None:
            by_cue.update(of_face.by_cue)
        curve = drawn.inverse.astype(np.float32)
        yield Example(path.name, drawn.family, drawn.row, measured, curve, by_cue, drawn.mixed_with)


@dataclass(frozen=True, slots=True, eq=False)
class _Stand:
    """A head at one size, the face in it, and where the cut of the face begins."""

    linear: npt.NDArray[np.float32]
    view: FaceView
    corner: tuple[int, int]


def _stands(path: Path, linear: npt.NDArray[np.float32], settings: Settings) -> tuple[_Stand, ...]:
    """The head as stored, and at the other sizes at which its face is still found."""
    stands = [_Stand(linear, *_view(path, linear, settings))]
    for size in _SIZES:
        how = cv2.INTER_AREA if size < 1.0 else cv2.INTER_CUBIC
        resized = cv2.resize(linear, None, fx=size, fy=size, interpolation=how)
        scaled: npt.NDArray[np.float32] = np.clip(resized, 0.0, 1.0).astype(np.float32)
        try:
            stands.append(_Stand(scaled, *_view(path, scaled, settings)))
        except PhotoError:
            continue
    return tuple(stands)


def _view(
    path: Path, linear: npt.NDArray[np.float32], settings: Settings
) -> tuple[FaceView, tuple[int, int]]:
    """The largest face, found in the picture as sRGB has it, and where its cut begins."""
    seen = _encode(linear, fixed_curve("srgb", np.linspace(0.0, 1.0, 1024), dorf_model()))
    found = find_faces(seen, settings)
    if not found.faces:
        raise PhotoError(path, "shows no face", "leave it out of the training")
    face = max(found.faces, key=lambda candidate: float(candidate.box_xy[2]))
    view = cut_face(Photo(seen, 8), face, settings)
    start = np.floor(face.landmarks_xyz[:, :2].min(axis=0) - 0.05 * face.box_xy[2])
    left, top = np.maximum(start, 0).astype(int)
    return view, (int(left), int(top))


def _look_again(stand: _Stand, encoded: npt.NDArray[np.float32]) -> FaceView:
    view, (left, top) = stand.view, stand.corner
    height, width = view.native.shape[:2]
    native = encoded[top : top + height, left : left + width]
    scaled = native
    if view.encoded.shape != native.shape:
        size = view.encoded.shape[1::-1]
        scaled = np.asarray(cv2.resize(native, size, interpolation=cv2.INTER_AREA), np.float32)
    return replace(view, encoded=scaled, native=native)


def _encode(linear: npt.NDArray[np.float32], inverse: Float) -> npt.NDArray[np.float32]:
    """To 8-bit codes, by a table over the root of light, which resolves the shadows."""
    grid = np.linspace(0.0, 1.0, inverse.size)
    nodes = np.linspace(0.0, 1.0, _LEVELS) ** 2
    table = np.rint(np.interp(nodes, inverse + np.arange(inverse.size) * 1e-9, grid) * 255.0)
    index = np.rint(np.sqrt(linear) * (_LEVELS - 1)).astype(np.intp)
    return np.asarray(table[index] / 255.0, dtype=np.float32)


def _frame(
    encoded: npt.NDArray[np.float32], stand: _Stand, generator: np.random.Generator
) -> npt.NDArray[np.float32]:
    """The photo framed more or less closely around its face: other surroundings, other levels."""
    if generator.random() < 0.5:
        return encoded
    (left, top), (tall, wide) = stand.corner, stand.view.native.shape[:2]
    height, width = encoded.shape[:2]
    rows = slice(generator.integers(top + 1), generator.integers(top + tall, height + 1))
    columns = slice(generator.integers(left + 1), generator.integers(left + wide, width + 1))
    return encoded[rows, columns]
