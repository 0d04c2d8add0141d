"""What tells pictures without a curve: weights of `joint.face_parts` and of `joint.few_levels`.

Learned from portraits of unknown cameras and from rendered heads, as they are and made wrong, by
what the estimator itself measures in them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np

from facecrf_ocio.benchmark.images import LinearImage
from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.benchmark.stress import StressBench, StressPlan, StressTask, choose_cells
from facecrf_ocio.errors import FaceCRFError, SettingsError
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.face.view import FaceView, cut_face
from facecrf_ocio.files.plain_text import counted
from facecrf_ocio.joint import face_parts, few_levels
from facecrf_ocio.joint.face_parts import ORDERS, FaceColors
from facecrf_ocio.photo.raster.pixels import eight_bit
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.settings import JointSettings
from facecrf_ocio.synthetic.jpeg import Codes
from facecrf_ocio.training.made_wrong import (
    AS_IT_IS,
    LIGHTS,
    OF_CONTRAST,
    PROCESSED,
    PUSHED,
    WITH_GRAIN,
    inverted,
    ordinary,
    posters,
)
from facecrf_ocio.training.plan import Data
from facecrf_ocio.training.portraits import portrait_paths
from facecrf_ocio.training.regressions import first_of, two_classes
from facecrf_ocio.values import Face, Float, Photo

RENDERED = 130
"""Photos of rendered heads: as many as tell what light from one side and very dark skin do."""
_SEED = 1  # any; of heads, responses and conditions
_SOLVED = "stacks"  # as `plan.Data` names them
_LONGEST = 1600  # [px] of a side; larger portraits cost time alone
_LEAST_COLOR = 1.0  # [code] between channels; less is what a JPEG makes of gray
_RIDGE, _RIDGE_OF_ORDERS = 1.0, 3.0  # of a scaled weight, chosen by judgment
# [log odds] at which brightness counts as inverted: more than eyes beside dark skin have, of which
# these portraits show few (docs/evidence).
_SURE = 5.2
# Of ordinary photos, of photos with grain and of photos with gaps, what is below the limit: such
# ones are rarer, so more of them may be above. By judgment.
_BELOW = (
    (0.99, (AS_IT_IS, PROCESSED)),
    (0.985, (WITH_GRAIN,)),
    (0.985, (PUSHED, OF_CONTRAST)),
)


@dataclass(frozen=True, slots=True, eq=False)
class ToldByFace:
    """What the estimator measures in one portrait, and in what was made of it.

    Attributes
    ----------
    colors
        Of the face; none through a curve from exposure stacks, whose red and blue are far off.
    upright, inverted
        (8,) and (K, 8) `face_parts.brightness_told`; K up to 2, as faces are still seen.
    ordinary, posters
        (3,) `few_levels.grain_told`, each with what was made; none of a rendered head.
    """

    colors: FaceColors | None
    upright: Float
    inverted: Float
    ordinary: tuple[tuple[str, Float], ...] = ()
    posters: tuple[tuple[int, Float], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class PartWeights:
    """As `face_parts` and `few_levels` have them, rounded as there."""

    bright: Float
    inverted: float
    colored: Float
    grainy: Float
    most_grainy: float

    def __str__(self) -> str:
        """As they stand in the code."""
        return (
            f"BRIGHT = {self.bright.tolist()}\nINVERTED = {self.inverted}\n"
            f"COLORED = {self.colored.tolist()}\n"
            f"GRAINY, MOST_GRAINY = {self.grainy.tolist()}, {self.most_grainy}"
        )


SHIPPED = PartWeights(
    face_parts.BRIGHT,
    face_parts.INVERTED,
    face_parts.COLORED,
    few_levels.GRAINY,
    few_levels.MOST_GRAINY,
)
"""Those in the code."""


def told_by_portraits(paths: Sequence[Path], seed: int) -> Iterator[ToldByFace]:
    """Of each portrait in color whose face shows all parts; others are passed over."""
    for number, path in enumerate(paths):
        try:
            codes = _reduced(eight_bit(read_photo(path).pixels))
        except FaceCRFError:
            continue
        if codes.std(axis=2).mean() >= _LEAST_COLOR:
            told = told_by(codes, np.random.default_rng([seed, number]), with_levels=True)
            if told is not None:
                yield told


def told_by_folder(folder: Path, seed: int) -> list[ToldByFace]:
    """Of the portraits below a folder.

    Raises
    ------
    SettingsError
        If it holds no photo, or none with a face.
    """
    paths = portrait_paths(folder)
    found = list(told_by_portraits(paths, seed))
    if not found:
        shown = f"none of {counted(len(paths), 'photo')} shows a whole face in color"
        raise SettingsError(f"{folder}: {shown}; give photos of faces")
    return found


def told_by_heads(data: Data, count: int = RENDERED) -> Iterator[ToldByFace]:
    """Of rendered heads, by the camera of a day through responses of all files."""
    images = tuple(LinearImage(path.name, path, "") for path in data.heads())
    if not images:
        raise SettingsError(f"{data.root}: holds no faces/rendered/img/train_*_noisy.exr")
    names = ("dorf", *data.digital)
    files = [read_responses(path) for path in (data.dorf, *data.digital.values())]
    cells = choose_cells("day")
    benches = [
        StressBench(StressPlan("", images, one, (), cells=cells, seed=_SEED)) for one in files
    ]
    generator = np.random.default_rng(_SEED)
    for number in range(count):
        file = int(generator.integers(len(files)))
        head, row = (int(generator.integers(n)) for n in (len(images), len(files[file].names)))
        photo = benches[file].photograph(StressTask(cells[0].name, number, head, row))
        told = told_by(
            eight_bit(photo.pixels), np.random.default_rng([_SEED, number]), with_levels=False
        )
        if told is not None:
            yield replace(told, colors=None) if names[file] == _SOLVED else told


def told_by(
    codes: Codes, generator: np.random.Generator, *, with_levels: bool
) -> ToldByFace | None:
    """Of (H, W, 3) codes; None without a face that shows all parts."""
    seen = _seen(codes)
    if seen is None:
        return None
    face, view, colors = seen
    wrong = [_seen(made) for made in inverted(codes, generator)]
    bright = [face_parts.brightness_told(one[1]) for one in wrong if one is not None]
    of_brightness = face_parts.brightness_told(view), np.reshape(bright, (-1, 8))
    if not with_levels:
        return ToldByFace(colors, *of_brightness)
    plain = tuple((kind, _grain(made, face)) for kind, made in ordinary(codes, generator))
    few = tuple((levels, _grain(made, face)) for levels, made in posters(codes, generator))
    return ToldByFace(colors, *of_brightness, plain, few)


def learn(portraits: Sequence[ToldByFace], heads: Sequence[ToldByFace], seed: int) -> PartWeights:
    """Fit all weights and limits."""
    both = [*portraits, *heads]
    faces = [one.colors for one in both if one.colors is not None]
    upright = np.array([one.upright for one in both])
    wrong = np.vstack([one.inverted for one in both])
    if not len(wrong):
        raise SettingsError("no face is found once it is inverted; give more portraits")
    bright, constant = two_classes(upright, wrong, _RIDGE, balanced=True)
    grainy, most = _of_grain(portraits)
    return PartWeights(
        np.round(bright, 2),
        round(_SURE - constant, 1),
        np.round(first_of(_orders(faces, seed), _RIDGE_OF_ORDERS), 2),
        np.round(grainy, 2),
        round(most, 2),
    )


def in_orders(colors: FaceColors) -> Float:
    """(6, 14) `face_parts.colors_told` of channels as they are, and in each other order."""
    orders = ((0, 1, 2), *ORDERS)
    return np.array([face_parts.colors_told(colors.in_order(order)) for order in orders])


def _orders(faces: Sequence[FaceColors], seed: int) -> Float:
    generator = np.random.default_rng(seed)
    lights = [LIGHTS[AS_IT_IS], *LIGHTS.values()]  # twice as they are
    return np.array([in_orders(light.on(one, generator)) for light in lights for one in faces])


def _of_grain(portraits: Sequence[ToldByFace]) -> tuple[Float, float]:
    kinds = [kind for one in portraits for kind, _ in one.ordinary]
    plain = np.array([told for one in portraits for _, told in one.ordinary])
    few = np.array([told for one in portraits for _, told in one.posters])
    weights, _ = two_classes(plain, few, _RIDGE, balanced=False)
    limits = [np.quantile(plain[np.isin(kinds, some)] @ weights, below) for below, some in _BELOW]
    return weights, float(max(limits))


def _grain(codes: Codes, face: Face) -> Float:
    return few_levels.grain_told(few_levels.face_codes(codes, face.box_xy))


def _seen(codes: Codes) -> tuple[Face, FaceView, FaceColors] | None:
    """The largest face as the estimator looks at it."""
    photo, settings = Photo.of_codes(codes), JointSettings()
    faces = find_faces(photo.pixels, settings, most=1).faces
    if not faces:
        return None
    view = cut_face(photo, faces[0], settings)
    colors = face_parts.face_colors(view, photo.pixels)
    return None if colors is None else (faces[0], view, colors)


def _reduced(codes: Codes) -> Codes:
    scale = _LONGEST / max(codes.shape[:2])
    if scale >= 1.0:
        return codes
    return np.asarray(
        cv2.resize(codes, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), np.uint8
    )
