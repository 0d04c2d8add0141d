"""How a photo is framed: its size, where the face is, and what surrounds it.

Only what the estimator looks at (`joint.windows`) is ever made: the face at working size and some
of the windows at native size, so a photo of 20 megapixels costs no more than a small one.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.joint.windows import Window
from facecrf_ocio.training.before_camera import Head, Texture, scaled_face
from facecrf_ocio.values import Face, Float

Light = npt.NDArray[np.float32]
NARROWEST, WIDEST = 62.0, 2600.0
"""[px] Width of faces: the estimator takes none narrower than 60."""
_USUAL, _SPREAD = 330.0, 1.0  # px; deviation of the logarithm
_LARGEST = 24e6  # px of a photo
# Of cameras, phones and squares, lying and standing.
_ASPECTS = (3 / 2, 4 / 3, 1.0, 3 / 4, 2 / 3, 9 / 16)
_OUT_OF_FOCUS = 0.6  # share of photos whose surroundings are; by judgment of portraits
# Of the photo's width: a 50 mm lens at f/8 to an 85 mm lens at f/1.8 with a face at two meters.
_DEFOCUS = (5e-4, 0.02)
_WIDEST_DISC = 40.0  # px; wider ones leave no edge inside a window
_LANDMARKS_OFF = 0.01  # of the face's width: landmarks are off by about 1 %
_ALIGNED = 16  # [px] side of JPEG's blocks of color at 4:2:0, which windows must not cut


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """One photo's frame, and how the picture of the head lies in it.

    Attributes
    ----------
    height, width
        [px] Of the photo as stored.
    scale, offset
        Pixels of the photo per pixel of the head's picture, and (x, y) of the picture's corner.
    face
        In pixels of the photo.
    surroundings, zoom, shade
        Picture beside the head's, pixels of the photo per pixel of it, factor of its light.
    defocus
        [px] Radius of the disc that a point of the surroundings is spread over, 0 if sharp.
    texture, texture_around
        Of the head's picture, and of its surroundings.
    """

    height: int
    width: int
    scale: float
    offset: Float
    face: Face
    surroundings: Light
    zoom: float
    shade: Float
    defocus: float
    texture: Texture
    texture_around: Texture

    def light(
        self, picture: Light, window: Window, size: tuple[int, int], generator: np.random.Generator
    ) -> Light:
        """Light (h, w, 3) of a window of the photo, `size` pixels of the sensor."""
        rows, columns = window
        step = ((columns.stop - columns.start) / size[1], (rows.stop - rows.start) / size[0])
        x, y = (
            np.array([start, start + step_ * count]) - offset
            for start, step_, count, offset in (
                (columns.start, step[0], size[1], self.offset[0]),
                (rows.start, step[1], size[0], self.offset[1]),
            )
        )
        height, width = picture.shape[:2]
        inside = (
            x[0] >= 0 and y[0] >= 0 and x[1] <= width * self.scale and y[1] <= height * self.scale
        )
        around = None if inside else self._around(size, step[0], generator)
        if x[1] <= 0 or y[1] <= 0 or x[0] >= width * self.scale or y[0] >= height * self.scale:
            return self._around(size, step[0], generator) if around is None else around
        light = _cut(picture, (x[0], y[0]), step, self.scale, size)
        light = self.texture.over(light, generator)
        if around is None:
            return light
        seen_x = x[0] + step[0] * (np.arange(size[1]) + 0.5)
        seen_y = y[0] + step[1] * (np.arange(size[0]) + 0.5)
        shown = ((seen_y >= 0) & (seen_y <= height * self.scale))[:, None] & (
            (seen_x >= 0) & (seen_x <= width * self.scale)
        )
        return np.where(shown[..., None], light, around)

    def _around(self, size: tuple[int, int], step: float, generator: np.random.Generator) -> Light:
        height, width = self.surroundings.shape[:2]
        corner = generator.uniform(0.0, 1.0, 2) * (width, height) * self.zoom
        light = _cut(self.surroundings, tuple(corner), (step, step), self.zoom, size)
        light = _defocused(light, self.defocus / step)
        return np.asarray(self.texture_around.over(light, generator) * self.shade, np.float32)


def _defocused(light: Light, radius: float) -> Light:
    """Each point of light (H, W, 3) spread over a disc of this radius [px]."""
    if radius < 0.5:
        return light
    reach = int(np.ceil(radius))
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    disc = np.clip(radius + 0.5 - np.hypot(x, y), 0.0, 1.0).astype(np.float32)
    blurred = cv2.filter2D(light, -1, disc / disc.sum(), borderType=cv2.BORDER_REFLECT)
    return np.asarray(np.maximum(blurred, 0.0), np.float32)


def _draw_defocus(width: float, generator: np.random.Generator) -> float:
    if generator.random() >= _OUT_OF_FOCUS:
        return 0.0
    least, most = _DEFOCUS
    share = np.exp(generator.uniform(np.log(least), np.log(most)))
    return float(min(share * width, _WIDEST_DISC))


def _cut(
    picture: Light,
    corner: tuple[float, float],
    step: tuple[float, float],
    scale: float,
    size: tuple[int, int],
) -> Light:
    """Part of an enlarged picture, mirrored beyond its edges.

    Parameters
    ----------
    picture
        (H, W, 3).
    corner, step
        x and y of the part's corner, and of its pixels, in pixels of the enlarged picture.
    scale
        Of the enlargement.
    size
        Rows and columns.
    """
    while scale < 0.6 * min(step):
        half = (max(1, picture.shape[1] // 2), max(1, picture.shape[0] // 2))
        picture = np.asarray(cv2.resize(picture, half, interpolation=cv2.INTER_AREA), np.float32)
        scale *= 2.0
    matrix = np.array(
        [
            [step[0] / scale, 0.0, (corner[0] + 0.5 * step[0]) / scale - 0.5],
            [0.0, step[1] / scale, (corner[1] + 0.5 * step[1]) / scale - 0.5],
        ]
    )
    how = cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP
    light = cv2.warpAffine(picture, matrix, size[::-1], flags=how, borderMode=cv2.BORDER_REFLECT)
    return np.asarray(np.maximum(light, 0.0), np.float32)


def draw_layout(head: Head, around: tuple[Light, ...], generator: np.random.Generator) -> Layout:
    """Frame a head: faces of 60 to 2,600 pixels in photos of up to 24 megapixels."""
    points = head.face.landmarks_xyz[:, :2]
    own_width = float(np.ptp(points[:, 0]))
    own_size = np.ptp(points, axis=0) * 1.25  # with the margins of the cut
    wanted = np.exp(generator.normal(np.log(_USUAL), _SPREAD))
    face_width = float(np.clip(wanted, NARROWEST, WIDEST))
    aspect = float(generator.choice(_ASPECTS))
    share = np.exp(generator.uniform(np.log(0.1), np.log(0.6)))
    width = face_width / share
    height = width / aspect
    shrink = min(1.0, np.sqrt(_LARGEST / (width * height)))
    scale = face_width / own_width
    least = own_size * scale
    width, height = max(width * shrink, least[0]), max(height * shrink, least[1])
    middle = points.mean(axis=0) * scale
    free = np.array([width, height]) - least
    place = 0.5 * least + free * (0.5 + generator.uniform(-0.5, 0.5, 2) * generator.random(2))
    offset = place - middle
    jitter = generator.normal(0.0, _LANDMARKS_OFF * own_width, 2)
    face = scaled_face(head.face, scale * float(np.exp(generator.normal(0.0, 0.015))), offset)
    face = scaled_face(face, 1.0, jitter * scale)
    tint = np.exp(generator.normal(0.0, 0.12, 3))
    return Layout(
        int(height),
        int(width),
        scale,
        offset,
        face,
        around[int(generator.integers(len(around)))],
        float(np.exp(generator.uniform(np.log(0.7), np.log(2.0)))),
        (np.exp(generator.normal(0.0, 0.9)) * tint).astype(np.float32),
        _draw_defocus(width, generator),
        Texture.draw(generator),
        Texture.draw(generator),
    )


def some_windows(
    windows: list[Window], most: int, side: int, generator: np.random.Generator
) -> tuple[list[Window], float]:
    """At most so many parts of windows, no side longer than given, and how much each stands for."""
    chosen = generator.permutation(len(windows))[:most]
    parts = []
    for rows, columns in (windows[i] for i in chosen):
        parts.append((_part(rows, side, generator), _part(columns, side, generator)))
    return parts, _area(windows) / _area(parts)


def _part(cut: slice, side: int, generator: np.random.Generator) -> slice:
    size = cut.stop - cut.start
    if size <= side:
        return cut
    start = cut.start + int(generator.integers((size - side) // _ALIGNED + 1)) * _ALIGNED
    return slice(start, start + side)


def _area(windows: list[Window]) -> float:
    return float(sum((r.stop - r.start) * (c.stop - c.start) for r, c in windows))
