"""The same points of a scene in several frames of a clip: flat patches, followed by their flow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Bool, Float

SIDE = 384  # [px] longest side of frames while points are followed
LOWEST, HIGHEST = 6.0, 246.0  # [code value] between which a patch is neither drowned nor clipped
_PATCH = 4  # [px] of the small frames
_FLAT = 3.0  # [code value] standard deviation within a patch: at edges flow is half a pixel off
_MOST = 1600  # patches that are kept
FEWER = 600  # of them for what is solved for time and again; more tell the same of a curve
_BINS = 16  # of code values, of which equally many patches are taken
_FEWEST = 40  # patches that tell anything

Image = npt.NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class TrackedPoints:
    """Code values of the same points.

    Attributes
    ----------
    codes
        (J, N, 3) mean code values of patches, 0 to 255.
    usable
        (J, N) where a patch is flat, and neither drowned nor clipped.
    places
        (N, 2) of the patches in the picture, x and y from 0 to 1.
    """

    codes: Float
    usable: Bool
    places: Float


def shrunk(encoded: Image) -> Image:
    """A frame (H, W, 3) as points are followed in it, no side longer than `SIDE`."""
    scale = SIDE / max(encoded.shape[:2])
    if scale >= 1.0:
        return encoded
    size = tuple(max(1, round(length * scale)) for length in encoded.shape[1::-1])
    return np.asarray(cv2.resize(encoded, size, interpolation=cv2.INTER_AREA), np.float32)


def track(frames: Sequence[Image]) -> TrackedPoints | None:
    """Follow flat patches of the middle frame through all others; None where too few are left.

    Parameters
    ----------
    frames
        (J, h, w, 3) small frames of one shot, encoded, [0, 1].
    """
    reference = frames[len(frames) // 2]
    flow = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    target = _equalized(reference)
    y, x = np.mgrid[: target.shape[0], : target.shape[1]].astype(np.float32)
    codes, usable = [], []
    for frame in frames:
        seen = frame
        if frame is not reference:
            moved = flow.calc(target, _equalized(frame), np.zeros((*target.shape, 2), np.float32))
            # Outside of the frame nothing is known: there it is black, and so drowned.
            seen = np.asarray(
                cv2.remap(frame, x + moved[..., 0], y + moved[..., 1], cv2.INTER_LINEAR),
                np.float32,
            )
        mean, rough, places = _patches(seen)
        codes.append(mean)
        inside = (mean.min(axis=1) >= LOWEST) & (mean.max(axis=1) <= HIGHEST)
        usable.append(inside & (rough < _FLAT))
    followed = TrackedPoints(np.stack(codes), np.stack(usable), places)
    found = thinned(followed, _MOST)
    return found if found.codes.shape[1] >= _FEWEST else None


def _equalized(frame: Image) -> npt.NDArray[np.uint8]:
    """Gray by its ranks, which exposure and curve leave alone."""
    gray = cv2.cvtColor(np.ascontiguousarray(frame), cv2.COLOR_RGB2GRAY)
    return np.asarray(cv2.equalizeHist(np.rint(255.0 * gray).astype(np.uint8)))


def _patches(frame: Image) -> tuple[Float, Float, Float]:
    """(N, 3) means of patches, (N,) largest deviations within them [code value], (N, 2) places."""
    rows, columns = frame.shape[0] // _PATCH, frame.shape[1] // _PATCH
    cut = frame[: rows * _PATCH, : columns * _PATCH].astype(np.float64) * 255.0
    blocks = cut.reshape(rows, _PATCH, columns, _PATCH, 3)
    rough = blocks.std(axis=(1, 3)).max(axis=2)
    y, x = (np.mgrid[:rows, :columns] + 0.5) * _PATCH
    places = np.stack([x / frame.shape[1], y / frame.shape[0]], axis=-1)
    return blocks.mean(axis=(1, 3)).reshape(-1, 3), rough.reshape(-1), places.reshape(-1, 2)


def thinned(points: TrackedPoints, most: int) -> TrackedPoints:
    """As many dark patches as bright ones of the middle frame, each usable in two frames and more.

    Fewer than `most` where the scene has no more.
    """
    told = np.flatnonzero(points.usable.sum(axis=0) >= 2)
    bright = points.codes[len(points.codes) // 2, told].mean(axis=1)
    bins = np.minimum((bright * _BINS / 256.0).astype(np.intp), _BINS - 1)
    generator = np.random.default_rng(0)
    kept = [generator.permutation(told[bins == index])[: most // _BINS] for index in range(_BINS)]
    chosen = np.sort(np.concatenate(kept))
    return TrackedPoints(points.codes[:, chosen], points.usable[:, chosen], points.places[chosen])
