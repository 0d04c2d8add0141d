"""The photos of a bracket on one grid, and the patches of them that tell of the response."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import PhotoError, SettingsError
from facecrf_ocio.pair.bracket_curve import HIGHEST, LOWEST
from facecrf_ocio.values import Bool, Float, Photo

WORKING_SIDE = 1024
"""[px] Longest side of the photos while they are compared."""
_ALIGN_SIDE = 640  # [px]
_STEPS, _PRECISION = 60, 1e-5  # at most, and gain of correlation, at which ECC ends; by judgment
# What a movement must bring to be believed: of correlation, and of what it lacks to 1.
_GAIN, _LESS = 0.002, 0.25
_STILL = 0.3  # [px] less than which is not worth resampling
_FEWEST_SEEN = 0.05  # of the pixels, clipped in neither photo
_PATCH = 5  # [px]
_FLAT = 3.0  # [code value] standard deviation within a patch
_BINS, _PER_BIN = 24, 40  # of about ten codes, and patches of each of all photos; by judgment
_CENTER = 0.5  # of half the diagonal: how far out points are taken where f-numbers differ

Image = npt.NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class SmallBracket:
    """A bracket, small enough to be held at once.

    Attributes
    ----------
    paths
        Of its photos, in the order given.
    images
        Each (h, w, 3) code values, [0, 1], shrunk.
    size
        (width, height) [px] of the photos themselves.
    stops
        (J,) exposures.
    warps
        (J, 2, 3) each photo's movement: where a full-size pixel of the reference lies in it.
    reference
        Index of the photo that others are laid over.
    """

    paths: tuple[Path, ...]
    images: tuple[Image, ...]
    size: tuple[int, int]
    stops: Float
    warps: Float
    reference: int


def small_bracket(photos: Iterable[Photo], stops: Float) -> SmallBracket:
    """Shrink photos one after another, and find how the camera moved between them.

    Raises
    ------
    PhotoError
        If there are fewer than two, if sizes differ, or if one of them is scene-linear.
    SettingsError
        If there are more or fewer exposures.
    """
    paths: list[Path] = []
    images: list[Image] = []
    size = (0, 0)
    for photo in photos:
        height, width = photo.encoded.shape[:2]
        _check(photo, (width, height), size)
        size = (width, height)
        paths.append(photo.path or Path(f"photo {len(paths) + 1}"))
        images.append(_shrunk(photo.encoded, WORKING_SIDE))
    if len(images) < 2:
        raise no_bracket(paths[0] if paths else None)
    if stops.shape != (len(images),):
        count = len(stops) if stops.ndim == 1 else f"an array {stops.shape} of"
        raise SettingsError(f"{count} exposures for {len(images)} photos; give one for each")
    reference = int(np.argmax([_usable_share(image) for image in images]))
    warps = _warps(images, stops, reference)
    scale = size[0] / images[0].shape[1]
    warps[:, :, 2] *= scale
    return SmallBracket(tuple(paths), tuple(images), size, stops, warps, reference)


def no_bracket(path: Path | None) -> PhotoError:
    """Why one photo is refused."""
    remedy = "give two exposures of the scene or more"
    return PhotoError(path, "is one photo, and no bracket", remedy)


def flat_patches(bracket: SmallBracket, *, center_only: bool) -> tuple[Float, Bool]:
    """Mean code values (J, N, 3) of patches, and where (J, N) they are flat.

    Of each photo and each range of codes some are taken, so that all of the curve is seen.

    Parameters
    ----------
    bracket
        As `small_bracket` gives it.
    center_only
        Take none from the corners, which f-numbers darken differently.
    """
    means, spreads = zip(*(_patches(image) for image in _aligned(bracket)), strict=True)
    codes, rough = np.stack(means), np.stack(spreads)
    # Outside of a moved photo pixels are negative; a drowned or clipped patch is flat, and nothing.
    usable = (codes.min(axis=3) >= LOWEST) & (codes.max(axis=3) <= HIGHEST) & (rough < _FLAT)
    if center_only:
        usable &= _central(usable.shape[1:])
    codes, usable = codes.reshape(len(codes), -1, 3), usable.reshape(len(codes), -1)
    usable &= usable.sum(axis=0) >= 2
    chosen = _chosen(codes, usable)
    return codes[:, chosen], usable[:, chosen]


def _check(photo: Photo, size: tuple[int, int], others: tuple[int, int]) -> None:
    if photo.scene_linear:
        raise PhotoError(
            photo.path, "is scene-linear, so it has no response to find", "give the camera's JPEGs"
        )
    if others not in ((0, 0), size):
        raise PhotoError(
            photo.path,
            f"has {size[0]} x {size[1]} pixels, the photos before it {others[0]} x {others[1]}",
            "give photos of one scene by one camera, as it wrote them",
        )


def _shrunk(image: Image, side: int) -> Image:
    scale = side / max(image.shape[:2])
    if scale >= 1.0:
        return image
    size = tuple(max(1, round(length * scale)) for length in image.shape[1::-1])
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.float32)


def _usable_share(image: Image) -> float:
    inside = (image.min(axis=2) > 0.06) & (image.max(axis=2) < 0.94)
    return float(inside.mean())


def _warps(images: Sequence[Image], stops: Float, reference: int) -> Float:
    """(J, 2, 3) of the shrunk photos: each is laid over its neighbor in exposure, and so on."""
    order = np.argsort(stops, kind="stable")
    warps = np.tile(np.eye(3), (len(images), 1, 1))
    start = int(np.flatnonzero(order == reference)[0])
    for way in (range(start + 1, len(order)), range(start - 1, -1, -1)):
        last = reference
        for place in way:
            step = _movement(images[last], images[order[place]])
            warps[order[place]] = step @ warps[last]
            last = int(order[place])
    return np.asarray(warps[:, :2])


def _movement(target: Image, source: Image) -> Float:
    """Shift and rotation (3, 3) from target to source pixels; none where none makes them alike."""
    small = [_shrunk(image, _ALIGN_SIDE) for image in (target, source)]
    scale = target.shape[1] / small[0].shape[1]
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, _STEPS, _PRECISION)
    clear = [(i.min(axis=2) * 255 >= LOWEST) & (i.max(axis=2) * 255 <= HIGHEST) for i in small]
    both = clear[0] & clear[1]
    if both.mean() < _FEWEST_SEEN:
        return np.eye(3)
    first, second = (_ranks_within(image, both) for image in small)
    mask = both.astype(np.uint8) * 255
    found: npt.NDArray[Any] = np.eye(2, 3, dtype=np.float32)
    try:
        before = cv2.computeECC(first, second, mask)
        after, warp = cv2.findTransformECC(
            first, second, found.copy(), cv2.MOTION_EUCLIDEAN, criteria, mask, 5
        )
        found = np.asarray(warp)
    except cv2.error:  # nothing that both see, or it did not converge
        return np.eye(3)
    whole = np.vstack([found, [0.0, 0.0, 1.0]])
    if after < before + max(_GAIN, _LESS * (1.0 - before)) or _farthest(whole, mask.shape) < _STILL:
        return np.eye(3)
    whole[:2, 2] *= scale
    return np.asarray(whole)


def _farthest(warp: Float, shape: tuple[int, ...]) -> float:
    """[px] that a movement shifts a corner."""
    height, width = shape
    corners = np.array([[0, 0, 1], [width, 0, 1], [0, height, 1], [width, height, 1]]).T
    return float(np.linalg.norm((warp @ corners - corners)[:2], axis=0).max())


def _ranks_within(image: Image, both: Bool) -> Image:
    """Luminance (H, W) by its rank among pixels (H, W) that two photos show: alike in both."""
    luminance = image @ np.array([0.3, 0.6, 0.1], np.float32)
    order = np.sort(luminance[both])
    order = order[:: max(1, order.size // 4096)]
    return np.asarray(np.searchsorted(order, luminance) / order.size, np.float32)


def warped(image: Image, warp: Float) -> Image:
    """A photo (H, W, 3) as the reference sees it, by a warp (2, 3) [px]; -1 where it has no pixels.

    Unmoved, it is kept as it is.
    """
    if np.array_equal(warp, np.eye(2, 3)):
        return image
    size = (image.shape[1], image.shape[0])
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    moved = cv2.warpAffine(image, warp, size, flags=flags, borderMode=cv2.BORDER_REPLICATE)
    inside = cv2.warpAffine(np.ones(image.shape[:2], np.float32), warp, size, flags=flags)
    return np.asarray(np.where(inside[..., None] > 0.4, moved, -1.0), np.float32)


def _aligned(bracket: SmallBracket) -> Iterable[Image]:
    scale = bracket.images[0].shape[1] / bracket.size[0]
    for image, warp in zip(bracket.images, bracket.warps, strict=True):
        small = warp.copy()
        small[:, 2] *= scale
        yield warped(image, small)


def _patches(image: Image) -> tuple[Float, Float]:
    """Mean (h, w, 3) and largest standard deviation (h, w) of each patch [code value]."""
    rows, columns = image.shape[0] // _PATCH, image.shape[1] // _PATCH
    cut = image[: rows * _PATCH, : columns * _PATCH].astype(np.float64) * 255.0
    blocks = cut.reshape(rows, _PATCH, columns, _PATCH, 3)
    return blocks.mean(axis=(1, 3)), blocks.std(axis=(1, 3)).max(axis=2)


def _central(shape: tuple[int, ...]) -> Bool:
    y, x = np.mgrid[: shape[0], : shape[1]]
    height, width = shape
    radius = np.hypot(x + 0.5 - width / 2.0, y + 0.5 - height / 2.0)
    return np.asarray(radius < _CENTER * np.hypot(width, height) / 2.0)


def _chosen(codes: Float, usable: Bool) -> npt.NDArray[np.intp]:
    """Indices of patches: for each photo some of each range of codes, evenly by chance.

    `codes` (J, P, 3) of J photos count where they are `usable` (J, P).
    """
    generator = np.random.default_rng(0)
    kept = np.zeros(usable.shape[1], np.bool_)
    most = max(4, _PER_BIN // len(codes))
    for one, clear in zip(codes, usable, strict=True):
        places = generator.permutation(np.flatnonzero(clear))
        bins = np.minimum((one[places].mean(axis=1) * _BINS / 256.0).astype(np.intp), _BINS - 1)
        for index in range(_BINS):
            kept[places[bins == index][:most]] = True
    return np.flatnonzero(kept)


def with_stops(bracket: SmallBracket, stops: Float) -> SmallBracket:
    """The same photos with exposures (J,) [stop] refined by the pixels."""
    return replace(bracket, stops=stops)
