"""Lay a linear picture over the encoded one of the same exposure, to a fraction of a pixel."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Bool, Float, Photo

WORKING_SIDE = 1400
"""[px] Longest side of the encoded picture while pictures are compared."""
MIN_CORRELATION = 0.75  # of ranks, below which the pictures are taken for two scenes
_MATCHES = 12  # of features; a homography needs four, and most of the others must agree
_ECC_STEPS, _ECC_PRECISION = 100, 1e-6  # at most, and the gain in correlation that ends them
_LENS_STEPS, _LENS_PIXELS = 6, 40_000  # of Gauss-Newton, and pixels that each looks at
_MIN_GRADIENT = 0.002  # [rank per px] below which a pixel cannot tell a shift

Image = npt.NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class Aligned:
    """Two pictures of one exposure on one grid.

    Attributes
    ----------
    encoded
        (H, W, 3) code values, [0, 1].
    linear
        (H, W, 3) relative linear light.
    both
        (H, W) True where both pictures have a value.
    correlation
        Of the two luminances after both were replaced by their ranks; 1 for the same picture.
    lens_shift
        [px] How far pixels had to be moved besides the homography; 90 % of them less than this.
    """

    encoded: Image
    linear: Image
    both: Bool
    correlation: float
    lens_shift: float = 0.0


def align(linear: Photo, encoded: Photo) -> Aligned:
    """Align a linear picture to an encoded one of other size, crop, orientation or lens correction.

    Both are compared by the ranks of their luminance, which no tone curve changes. A homography
    from matched features (SIFT, RANSAC) or from the sizes alone is refined by maximizing the
    enhanced correlation coefficient (Evangelidis and Psarakis, PAMI 2008); what a lens correction
    leaves is a cubic polynomial of position, found by Gauss-Newton steps over all pixels.
    """
    target = _shrink(encoded.encoded, WORKING_SIDE)
    source = _shrink(linear.encoded, 2 * WORKING_SIDE)
    tries = [_by_sizes(source, target), *_by_features(source, target)]
    results = [_refined(source, target, start) for start in tries]
    best = max(results, key=lambda aligned: aligned.correlation)
    return _lens_corrected(best) if best.correlation >= MIN_CORRELATION else best


def ranks(image: Image) -> Image:
    """(H, W) rank of the luminance of (H, W, 3), [0, 1]: alike for all increasing tone curves."""
    luminance = image @ np.array([0.3, 0.6, 0.1], np.float32)
    order = np.sort(luminance.ravel())[:: max(1, luminance.size // 4096)]
    place = np.searchsorted(order, luminance, side="left") + np.searchsorted(
        order, luminance, side="right"
    )
    return np.asarray(place / (2.0 * order.size), np.float32)


def _shrink(image: Image, side: int) -> Image:
    scale = side / max(image.shape[:2])
    return image if scale >= 1 else _scaled(image, scale)


def _scaled(image: Image, scale: float) -> Image:
    size = tuple(max(1, round(side * scale)) for side in image.shape[1::-1])
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.float32)


def _by_sizes(source: Image, target: Image) -> Float:
    """The homography (3, 3) from target to source pixels if both show the same frame."""
    (height, width), (to_height, to_width) = source.shape[:2], target.shape[:2]
    x, y = width / to_width, height / to_height
    return np.array([[x, 0, 0.5 * x - 0.5], [0, y, 0.5 * y - 0.5], [0, 0, 1]])


def _by_features(source: Image, target: Image) -> list[Float]:
    """The homography (3, 3) from target to source pixels that most matches agree on, if any."""
    sift = cv2.SIFT_create(4000)  # type: ignore[attr-defined]
    found = [sift.detectAndCompute(_bytes(ranks(image)), None) for image in (target, source)]
    (points, descriptors), (to_points, to_descriptors) = found
    if min(len(points), len(to_points)) < _MATCHES:
        return []
    nearest = cv2.BFMatcher().knnMatch(descriptors, to_descriptors, k=2)
    good = [
        pair[0] for pair in nearest if len(pair) == 2 and pair[0].distance < 0.8 * pair[1].distance
    ]
    if len(good) < _MATCHES:
        return []
    start = np.array([points[match.queryIdx].pt for match in good])
    end = np.array([to_points[match.trainIdx].pt for match in good])
    cv2.setRNGSeed(0)
    homography, inliers = cv2.findHomography(start, end, cv2.RANSAC, 3.0)
    if homography is None or int(inliers.sum()) < _MATCHES:
        return []
    return [np.asarray(homography, np.float64)]


def _bytes(image: Image) -> npt.NDArray[np.uint8]:
    return np.asarray(np.rint(255 * image), np.uint8)


def _refined(source: Image, target: Image, start: Float) -> Aligned:
    """Bring the source near to the target's scale, refine the homography (3, 3), and warp."""
    area = abs(float(np.linalg.det(start[:2, :2])))
    if area > 1.2:
        scale = 1 / np.sqrt(area)
        smaller = _scaled(source, scale)
        x, y = (smaller.shape[i] / source.shape[i] for i in (1, 0))
        start = np.array([[x, 0, 0.5 * x - 0.5], [0, y, 0.5 * y - 0.5], [0, 0, 1]]) @ start
        source = smaller
    warp = np.asarray(start / start[2, 2], np.float32)
    criteria = (
        cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT,
        _ECC_STEPS,
        _ECC_PRECISION,
    )
    template, moving = ranks(target), ranks(source)
    everywhere = np.full(moving.shape, 255, np.uint8)
    try:
        _, found = cv2.findTransformECC(
            template, moving, warp.copy(), cv2.MOTION_HOMOGRAPHY, criteria, everywhere, 5
        )
    except cv2.error:  # no overlap, or it did not converge: the start is judged instead
        found = warp
    results = [_warped(source, target, homography) for homography in (found, warp)]
    return max(results, key=lambda aligned: aligned.correlation)


def _warped(source: Image, target: Image, homography: npt.NDArray[Any]) -> Aligned:
    size = target.shape[1::-1]
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    linear = cv2.warpPerspective(source, homography, size, flags=flags)
    inside = np.ones(source.shape[:2], np.float32)
    both = cv2.warpPerspective(inside, homography, size, flags=flags) > 0.999
    return _compared(target, np.asarray(linear, np.float32), np.asarray(both, np.bool_))


def _compared(encoded: Image, linear: Image, both: Bool) -> Aligned:
    correlation = 0.0
    if both.mean() > 0.1:
        first, second = ranks(encoded)[both], ranks(linear)[both]
        if first.std() > 0 and second.std() > 0:
            correlation = float(np.corrcoef(first, second)[0, 1])
    return Aligned(encoded, linear, both, correlation)


def _lens_corrected(aligned: Aligned) -> Aligned:
    """Take off the smooth displacement that a homography cannot, if that makes both more alike."""
    height, width = aligned.both.shape
    y, x = np.mgrid[:height, :width].astype(np.float64)
    places = np.stack([x.ravel(), y.ravel()], axis=1)
    terms = _cubic(places, width, height)
    moved, best = np.zeros_like(places), aligned
    for _ in range(_LENS_STEPS):
        moved = moved + terms @ _displacement(best, terms)
        current = _moved(aligned, (places + moved).reshape(height, width, 2))
        if current.correlation <= best.correlation:
            break
        length = float(np.quantile(np.linalg.norm(moved, axis=1), 0.9))
        best = replace(current, lens_shift=length)
    return best


def _displacement(aligned: Aligned, terms: Float) -> Float:
    """Coefficients (10, 2) of the displacement that best explains the difference of the ranks.

    One Gauss-Newton step: where `linear` lies a displacement away, its rank differs by the
    gradient times that; clipped pixels and others that differ much are left out.
    """
    first, second = (
        cv2.GaussianBlur(ranks(image), (0, 0), 1.5).astype(np.float64)
        for image in (aligned.encoded, aligned.linear)
    )
    by_y, by_x = np.gradient(second)
    difference = first - second
    kept = aligned.both & (np.abs(difference) < 0.1)
    kept &= np.hypot(by_x, by_y) > _MIN_GRADIENT
    chosen = np.flatnonzero(kept)[:: max(1, int(kept.sum()) // _LENS_PIXELS)]
    if len(chosen) < 4 * terms.shape[1]:
        return np.zeros((terms.shape[1], 2))
    shapes = terms[chosen]
    system = np.hstack([shapes * by_x.ravel()[chosen, None], shapes * by_y.ravel()[chosen, None]])
    found, *_ = np.linalg.lstsq(system, difference.ravel()[chosen], rcond=None)
    return np.asarray(found.reshape(2, -1).T)


def _moved(aligned: Aligned, places: Float) -> Aligned:
    x, y = np.ascontiguousarray(places.transpose(2, 0, 1), np.float32)
    linear = cv2.remap(aligned.linear, x, y, cv2.INTER_LINEAR)
    inside = cv2.remap(aligned.both.astype(np.float32), x, y, cv2.INTER_LINEAR)
    return _compared(
        aligned.encoded, np.asarray(linear, np.float32), np.asarray(inside > 0.999, np.bool_)
    )


def _cubic(places: Float, width: int, height: int) -> Float:
    """All monomials up to the third degree of coordinates scaled to about [-1, 1], (N, 10)."""
    x, y = (2 * (places + 0.5) / [width, height] - 1).T
    return np.stack([x**i * y**j for i in range(4) for j in range(4 - i)], axis=1)
