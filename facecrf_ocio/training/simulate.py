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

from facecrf_ocio.benchmark.camera import FULL_WELL_ISO_100, READ_NOISE
from facecrf_ocio.cues.face import FaceView, cut_face
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.joint.statistics import face_statistics, photo_statistics
from facecrf_ocio.read import read_photo
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.settings import Settings
from facecrf_ocio.training.curves import CurveSource
from facecrf_ocio.values import Float, Photo

_LEVELS = 16384
_MEASURED_SHARE = 4  # one photo in so many is encoded by a measured response, without variation


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
    """

    head: str
    family: int
    row: int
    measured: bool
    inverse: npt.NDArray[np.float32]
    by_cue: dict[str, Float]


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
    view, corner = _view(path, linear, settings)
    generator = np.random.default_rng([seed, *path.name.encode()])
    for number in range(count):
        measured = number % _MEASURED_SHARE == 0
        drawn = source.draw(generator, measured=measured)
        light = linear if measured else _vary(linear, generator)
        encoded = _encode(light, drawn.inverse)
        if not measured and generator.random() < 0.3:
            encoded = _compress(encoded, int(generator.integers(80, 97)))
        by_cue = dict(photo_statistics(encoded))
        of_face = face_statistics(_look_again(view, encoded, corner), settings)
        if of_face is not None:
            by_cue.update(of_face.by_cue)
        curve = drawn.inverse.astype(np.float32)
        yield Example(path.name, drawn.family, drawn.row, measured, curve, by_cue)


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


def _look_again(
    view: FaceView, encoded: npt.NDArray[np.float32], corner: tuple[int, int]
) -> FaceView:
    height, width = view.native.shape[:2]
    native = encoded[corner[1] : corner[1] + height, corner[0] : corner[0] + width]
    size = view.encoded.shape[1::-1]
    scaled = native
    if view.encoded.shape != native.shape:
        scaled = np.asarray(cv2.resize(native, size, interpolation=cv2.INTER_AREA), np.float32)
    return replace(view, encoded=scaled, native=native)


def _vary(
    linear: npt.NDArray[np.float32], generator: np.random.Generator
) -> npt.NDArray[np.float32]:
    """Another exposure, white balance, noise and sharpness."""
    gains = 2.0 ** generator.uniform(-0.9, 0.5) * np.exp(generator.normal(0.0, 0.06, 3))
    light = linear * gains.astype(np.float32)
    if generator.random() < 0.5:
        full_well = FULL_WELL_ISO_100 / 2.0 ** generator.uniform(0.0, 5.0)
        deviation = np.sqrt(light / full_well + (READ_NOISE / full_well) ** 2)
        light = light + generator.standard_normal(light.shape, dtype=np.float32) * deviation
    if generator.random() < 0.3:
        light = np.asarray(cv2.GaussianBlur(light, (0, 0), generator.uniform(0.4, 1.5)))
    return np.asarray(np.clip(light, 0.0, 1.0), dtype=np.float32)


def _encode(linear: npt.NDArray[np.float32], inverse: Float) -> npt.NDArray[np.float32]:
    """To 8-bit codes, by a table over the root of light, which resolves the shadows."""
    grid = np.linspace(0.0, 1.0, inverse.size)
    nodes = np.linspace(0.0, 1.0, _LEVELS) ** 2
    table = np.rint(np.interp(nodes, inverse + np.arange(inverse.size) * 1e-9, grid) * 255.0)
    index = np.rint(np.sqrt(linear) * (_LEVELS - 1)).astype(np.intp)
    return np.asarray(table[index] / 255.0, dtype=np.float32)


def _compress(encoded: npt.NDArray[np.float32], quality: int) -> npt.NDArray[np.float32]:
    codes = np.rint(encoded * 255.0).astype(np.uint8)
    _, content = cv2.imencode(".jpg", codes[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])
    decoded = np.asarray(cv2.imdecode(content, cv2.IMREAD_COLOR), dtype=np.float32)
    return decoded[..., ::-1] / np.float32(255.0)
