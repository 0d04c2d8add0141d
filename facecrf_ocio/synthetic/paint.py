"""Eyes, brows, lips and nostrils, painted onto the face's texture."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.face.regions import LEFT_BROW, LEFT_EYE, LIPS, RIGHT_BROW, RIGHT_EYE
from facecrf_ocio.synthetic.skin_layers import TEXTURE_SIZE, to_texture
from facecrf_ocio.synthetic.spec import Color, Image, rgb
from facecrf_ocio.values import Float

# Vertices of the face mesh along each feature, the person's right side first.
EYES = tuple((eye[0], *reversed(eye[1:])) for eye in (RIGHT_EYE, LEFT_EYE))
UPPER_LIDS = (RIGHT_EYE[:9], LEFT_EYE[:9])  # from corner to corner
BROWS = (RIGHT_BROW, LEFT_BROW)
# Upper lip's outline then the lower's, corner to corner, inside.
LIPS_INNER = (78, 191, 80, 81, 82, 13, 312, 311, 310, 415, 308)  # vertices of the face mesh
NOSTRILS = ((60, 20, 242, 99), (290, 250, 462, 328))  # vertices of the face mesh

EYE_WHITE: Color = (0.50, 0.44, 0.41)  # albedo
DARK: Color = (0.01, 0.008, 0.007)  # albedo of pupils, nostrils and lashes
# Albedos: brown, blue, green.
IRIS_COLORS: tuple[Color, ...] = ((0.09, 0.04, 0.02), (0.05, 0.09, 0.13), (0.08, 0.09, 0.04))
# Albedos: black, brown, fair.
HAIR_COLORS: tuple[Color, ...] = ((0.012, 0.009, 0.008), (0.06, 0.033, 0.018), (0.16, 0.1, 0.055))


# The mesh's eyes are half shut; they are painted this much taller.
EYE_OPENING = 1.5
BROW_HAIRS = 450  # of each brow


@dataclass(frozen=True, slots=True, eq=False)
class FeaturePaint:
    """What covers or colors the skin of the face's texture.

    Attributes
    ----------
    color
        (T, T, 3) linear albedo of the paint, times its cover.
    cover
        (T, T) share of the skin that the paint hides, [0, 1].
    lips
        (T, T) how far a point belongs to the lips, [0, 1].
    """

    color: Image
    cover: Image
    lips: Image


def paint_features(rng: np.random.Generator, uv: Float, hair: Color) -> FeaturePaint:
    """Paint all features for the (468, 2) texture coordinates of the face mesh's vertices."""
    points = to_texture(uv)
    canvas = _Canvas.blank()
    iris = IRIS_COLORS[int(rng.integers(len(IRIS_COLORS)))]
    for eye, lid in zip(EYES, UPPER_LIDS, strict=True):
        _paint_eye(canvas, points[list(eye)], points[list(lid)], iris)
    for brow in BROWS:
        _paint_brow(canvas, rng, points[list(brow)], hair)
    for nostril in NOSTRILS:
        _paint_nostril(canvas, points[list(nostril)])
    _paint_mouth(canvas, points[list(LIPS_INNER)])
    lips = _blur(canvas.polygon(points[list(LIPS)]), 3.0)
    return FeaturePaint(canvas.color, canvas.cover, lips)


@dataclass(frozen=True, slots=True, eq=False)
class _Canvas:
    """Layers of paint, each over those before it, on the texture or a window of it."""

    color: Image
    cover: Image
    corner: Float

    @classmethod
    def blank(cls) -> _Canvas:
        size = (TEXTURE_SIZE, TEXTURE_SIZE)
        return cls(np.zeros((*size, 3), np.float32), np.zeros(size, np.float32), np.zeros(2))

    def around(self, points: Float, margin: float) -> _Canvas:
        """A window onto the same paint, for strokes that stay near points (N, 2) [texel]."""
        left, top = np.maximum(points.min(axis=0) - margin, 0).astype(int)
        right, bottom = (points.max(axis=0) + margin).astype(int) + 1
        box = np.s_[top:bottom, left:right]
        return _Canvas(self.color[box], self.cover[box], self.corner + np.array([left, top]))

    def add(self, cover: Image, color: Color | Image) -> None:
        alpha = np.where(cover < 1 / 255, 0, cover).astype(np.float32)
        self.color[:] += alpha[..., None] * (np.asarray(color, dtype=np.float32) - self.color)
        self.cover[:] += alpha * (1 - self.cover)

    def distance(self, center: Float, unit: float) -> Image:
        """(H, W) distance of each texel from a point (2,), in units of so many texels."""
        rows, columns = np.ogrid[: self.cover.shape[0], : self.cover.shape[1]]
        x, y = center - self.corner
        result: Image = (np.hypot(columns - x, rows - y) / unit).astype(np.float32)
        return result

    def polygon(self, points: Float) -> Image:
        mask = np.zeros(self.cover.shape, dtype=np.uint8)
        cv2.fillPoly(mask, [self._fixed_point(points)], 255, cv2.LINE_AA, 4)
        return mask * np.float32(1 / 255)

    def strokes(self, paths: list[Float], thickness: int) -> Image:
        mask = np.zeros(self.cover.shape, dtype=np.uint8)
        fixed = [self._fixed_point(path) for path in paths]
        cv2.polylines(mask, fixed, False, 255, thickness, cv2.LINE_AA, 4)
        return mask * np.float32(1 / 255)

    def _fixed_point(self, points: Float) -> npt.NDArray[np.int32]:
        return np.round((points - self.corner) * 16).astype(np.int32)


def _paint_eye(canvas: _Canvas, outline: Float, upper: Float, iris: Color) -> None:
    """White, iris, pupil, lashes, the upper lid's shade; outlines (N, 2) [texel] from a corner."""
    width = float(np.linalg.norm(outline[0] - outline[8]))
    canvas = canvas.around(outline, 0.4 * width)
    middle = outline.mean(axis=0)
    outline, upper = (middle + (points - middle) * (1, EYE_OPENING) for points in (outline, upper))
    opening = _blur(canvas.polygon(outline), 1.0)
    center = middle - (0, 0.02 * width)
    from_corner = np.clip(canvas.distance(middle, 0.5 * width), 0, 1)[..., None] ** 2
    canvas.add(opening, rgb(EYE_WHITE) * (1 - 0.5 * from_corner))
    distance = canvas.distance(center, 0.2 * width)
    canvas.add(opening * _within(distance, 1.0), rgb(iris) * (0.7 + 0.5 * distance[..., None]))
    canvas.add(0.7 * opening * _within(distance, 1.08) * (1 - _within(distance, 0.9)), DARK)
    canvas.add(opening * _within(distance, 0.42), DARK)
    shade = canvas.strokes([upper], int(0.14 * width))
    canvas.add(0.7 * opening * _blur(shade, 3), DARK)
    canvas.add(0.85 * _blur(canvas.strokes([upper], 4), 1.0), DARK)
    glint = canvas.distance(center - 0.07 * width, 0.035 * width)
    canvas.add(0.8 * opening * _within(glint, 1.0), (0.9, 0.9, 0.9))


def _paint_brow(canvas: _Canvas, rng: np.random.Generator, outline: Float, hair: Color) -> None:
    """Hairs within the outline (10, 2) [texel], which runs inward above and back outward below."""
    canvas = canvas.around(outline, 25.0)
    upper, lower = outline[:5], outline[:4:-1]
    along, across = rng.uniform(0, 3.999, BROW_HAIRS), rng.uniform(0.1, 0.9, BROW_HAIRS)
    part, rest = along.astype(int), (along % 1)[:, None]
    top = upper[part] * (1 - rest) + upper[part + 1] * rest
    bottom = lower[part] * (1 - rest) + lower[part + 1] * rest
    root = top + across[:, None] * (bottom - top)
    outward = np.sign(outline[0, 0] - outline[4, 0])
    inner = (along / 4)[:, None]
    lean = np.array([outward, -0.2]) * (1 - inner) + np.array([0.55 * outward, -0.8]) * inner
    lean = lean + rng.normal(0, 0.25, lean.shape)
    tip = root + lean * rng.uniform(4, 11, (BROW_HAIRS, 1))
    hairs = [np.stack(pair) for pair in zip(root, tip, strict=True)]
    strokes = np.sum([canvas.strokes(hairs[k::3], 1) for k in range(3)], axis=0)
    area = _blur(canvas.polygon(outline), 5)
    cover = np.clip(_blur(strokes, 1.0) * 0.5 + 0.3 * area, 0, 0.88)
    red, green, blue = (0.7 * value for value in hair)
    canvas.add(cover, (red, green, blue))


def _paint_nostril(canvas: _Canvas, rim: Float) -> None:
    center = rim.mean(axis=0)
    canvas = canvas.around(center[None], 30.0)
    rows, columns = np.ogrid[: canvas.cover.shape[0], : canvas.cover.shape[1]]
    x, y = center - canvas.corner
    radius = np.hypot((columns - x) / 13, (rows - y) / 8)
    canvas.add((0.85 * np.clip(2.5 * (1 - radius), 0, 1)).astype(np.float32), (0.03, 0.01, 0.008))


def _paint_mouth(canvas: _Canvas, seam: Float) -> None:
    canvas = canvas.around(seam, 15.0)
    cover = _blur(canvas.strokes([seam], 4), 1.5)
    canvas.add(0.9 * cover, (0.035, 0.012, 0.01))


def _within(distance: Image, radius: float) -> Image:
    """1 well inside of the radius, 0 well outside."""
    result: Image = np.clip((radius - distance) * 8 + 0.5, 0, 1).astype(np.float32)
    return result


def _blur(cover: Image, sigma: float) -> Image:
    """Gaussian blur that ends after three sigma, so that far texels stay exactly bare."""
    size = 2 * int(np.ceil(3 * sigma)) + 1
    return np.asarray(cv2.GaussianBlur(cover, (size, size), sigma), dtype=np.float32)
