"""What a photo shows that depends on its response: statistics of the skin and of the whole photo.

Each cue is a vector of numbers measured in encoded values. What they say of the response is
learned (`messages.py`), together with how far it can be trusted.

Two more were tried and dropped, because on heads that were not trained on they made the estimate
worse: quantiles of the whole photo (what auto-exposure tells), which the networks took to recognize
the training pictures, and brightness as a quadratic of the mesh's normals.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.face import regions
from facecrf_ocio.face.skin_mask import find_skin
from facecrf_ocio.face.view import MIN_SKIN_PIXELS, FaceView
from facecrf_ocio.joint.color_lines import bend_profile
from facecrf_ocio.joint.edges import edge_profile, soft_edge_profile
from facecrf_ocio.joint.grain import measure_noise, noise_curve
from facecrf_ocio.joint.noise_counts import NoiseCounts, count_noise
from facecrf_ocio.joint.second_differences import LEVELS
from facecrf_ocio.joint.texture import noise_character
from facecrf_ocio.joint.windows import Window, face_windows, photo_windows
from facecrf_ocio.photo.raster.pixels import Pixels
from facecrf_ocio.settings import FaceSettings
from facecrf_ocio.values import Bool, Float, frozen

FACE_CUES = ("shading", "highlights", "pigments", "eyes")
"""Measured on the face at its working size."""
CUES = ("grain", "noise", "edges", "soft_edges", "color_lines", "exposure", *FACE_CUES)
# Groups of skin by brightness, equally many pixels each; trained with, as all below.
SHADING_BINS = 12
PIGMENT_BINS = 4  # few, since each needs the scatter of its pixels, not their mean alone
# Shares of the photo's pixels; closer together toward both ends, where it clips.
EXPOSURE_QUANTILES = (0.02, 0.1, 0.25, 0.5, 0.75, 0.9, 0.98)
# Shares of the skin's pixels: the upper tenth, where gloss is.
HIGHLIGHT_QUANTILES = (0.9, 0.95, 0.98, 0.995)
# Shares of an eye's pixels: pupil and iris below, sclera and glint above.
EYE_QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
_DARKEST = 0.5 / 255.0  # [1] half a code of 8 bits, so that logarithms exist
_MIN_EYE_PIXELS = 20  # of five quantiles, four pixels between each; chosen by judgment
_ALMOST_WHITE, _ALMOST_BLACK = 253, 3  # codes
_RIGHT_LIDS, _LEFT_LIDS = (33, 133, 159, 145), (263, 362, 386, 374)  # corners, then lids
_CLOSED = 0.12  # height over width of an eye's opening


@dataclass(frozen=True, slots=True, eq=False)
class Statistics:
    """The numbers of every cue that a photo has.

    Attributes
    ----------
    by_cue
        For each cue of `CUES` that the photo shows, its vector.
    encoded
        (N, 3) a sample of the encoded values that they rest on.
    skin
        (H, W) which pixels of the face at working size are skin.
    """

    by_cue: Mapping[str, Float]
    encoded: Float
    skin: Bool


def photo_counts(pixels: Pixels) -> NoiseCounts:
    """What the windows of a whole photo hold, (H, W, 3) encoded or in 8 bits; it needs no face."""
    return count_noise([pixels[window] for window in photo_windows(*pixels.shape[:2])])


def skin_counts(
    pixels: Pixels, view: FaceView, skin: npt.NDArray[np.bool_], part: slice = slice(None)
) -> NoiseCounts:
    """What the windows of a face hold where they show skin.

    Parameters
    ----------
    pixels
        (H, W, 3) the whole photo, encoded or in 8 bits.
    view, skin
        The face cut out of it, and which of its pixels at working size are skin.
    part
        Of the windows, for several threads.
    """
    windows = face_windows(view.face.landmarks_xyz, *pixels.shape[:2])[part]
    return count_noise(
        [pixels[window] for window in windows],
        [resampled(skin, view.frame, window) for window in windows],
    )


def counted_statistics(photo: NoiseCounts, skin: NoiseCounts) -> dict[str, Float]:
    """Statistics that follow from counts: of all cues but those of the face.

    Noise against level and how far it is noise, all over the photo and on the skin, where edges
    have their middles, how colors blend across them, and how bright the photo is.
    """
    found = {}
    for cue, counts in (("grain", photo), ("noise", skin)):
        curve = noise_curve(measure_noise(counts))
        if curve is None:
            continue
        coarse = noise_curve(measure_noise(counts, 1))
        coarse = np.zeros(LEVELS + 1) if coarse is None else coarse[: LEVELS + 1]
        found[cue] = np.concatenate([curve, coarse, noise_character(counts)])
    if "grain" in found:
        found["grain"] = np.concatenate([found["grain"], _blocks(photo)])
    edges = edge_profile(photo)
    if edges is not None:
        found["edges"] = edges
    found["soft_edges"] = soft_edge_profile(photo.soft_edges, skin.soft_edges)
    found["color_lines"] = bend_profile(photo.color_lines, skin.color_lines)
    found["exposure"] = _exposure(photo)
    return found


def face_statistics(view: FaceView, settings: FaceSettings) -> Statistics | None:
    """Statistics of one face at its working size; None where it shows too little skin."""
    mask = find_skin(view.encoded, view.geometry.bare_skin, settings)
    if int(mask.skin.sum()) < MIN_SKIN_PIXELS:
        return None
    skin = _colors(view, mask.skin)
    skin = skin.take(np.argsort(_brightness(skin), kind="stable"), axis=0)
    found = {
        "shading": _shading(skin),
        "highlights": _highlights(_colors(view, view.geometry.bare_skin)),
        "pigments": _pigments(skin),
    }
    eyes = _eyes(view, skin)
    if eyes is not None:
        found["eyes"] = eyes
    return Statistics(found, frozen(skin[:: max(1, len(skin) // 512)]), mask.skin)


def _colors(view: FaceView, where: Bool) -> Float:
    """(N, 3) encoded values of some pixels (H, W); an index by a mask takes four times as long."""
    return view.encoded.reshape(-1, 3).compress(where.ravel(), axis=0).astype(np.float64)


def _brightness(colors: Float) -> Float:
    """(N,) mean of the channels of (N, 3): NumPy takes ten times as long along rows of three."""
    red, green, blue = colors.T
    return np.asarray((red + green + blue) / 3.0)


def _shading(skin: Float) -> Float:
    """Mean color at each brightness of the skin.

    Under one light chromaticity does not change with shading in linear light; how it does change
    in encoded values tells the shape of `log g` (and the brightest and darkest skin its spread).
    """
    means = np.array([part.mean(axis=0) for part in np.array_split(skin, SHADING_BINS)])
    logs = np.log(np.maximum(means, _DARKEST))
    green = logs[:, 1]
    return np.concatenate([green, logs[:, 0] - green, logs[:, 2] - green, means.mean(axis=1)])


def _highlights(bare: Float) -> Float:
    """Color of the brightest of bare skin (N, 3), where reflected light is added to its own."""
    luma = _brightness(bare)
    limits = quantiles_of(luma, (*HIGHLIGHT_QUANTILES, 0.4))
    return np.concatenate([bare.compress(luma >= limit, axis=0).mean(axis=0) for limit in limits])


def _pigments(skin: Float) -> Float:
    """Spread of the color of skin (N, 3), dark to bright, within each brightness.

    These are the pigments' contrasts in encoded logs, three numbers a brightness.
    """
    numbers = []
    for part in np.array_split(skin, PIGMENT_BINS):
        logs = np.log(np.maximum(part, _DARKEST))
        opponent = np.stack([logs[:, 0] - logs[:, 1], logs[:, 2] - logs[:, 1]])
        low, high = quantiles_of(opponent, (0.1, 0.9)).T
        widths = np.log(np.maximum(high - low, 1e-3))
        deviation = opponent.std(axis=1)
        red, blue = opponent - opponent.mean(axis=1, keepdims=True)
        correlation = (red * blue).mean()
        numbers += [*widths, correlation / max(float(deviation.prod()), 1e-6)]
    return np.array(numbers)


def quantiles_of(values: Float, shares: Sequence[float]) -> Float:
    """(..., S) quantiles of (..., N), bit by bit as NumPy has them, in a third of its time."""
    last = values.shape[-1] - 1
    place = last * np.array(shares)
    before = place.astype(np.intp)
    after = np.minimum(before + 1, last)
    ordered = np.partition(values, sorted({*before.tolist(), *after.tolist()}), axis=-1)
    low, high, part = ordered[..., before], ordered[..., after], place - before
    rise = high - low  # taken from the nearer end
    return np.asarray(np.where(part < 0.5, low + rise * part, high - rise * (1.0 - part)))


def _blocks(counts: NoiseCounts) -> Float:
    """(10,) how strongly a JPEG's blocks show: differences between blocks over those inside.

    Also how much of the codes is unused between the first and the last: what is left by a curve
    that was applied to codes.
    """
    total, number = np.moveaxis(counts.blocks, 2, 0)
    mean = total / np.maximum(number, 1.0) + 1e-2
    inside = mean[:, :-1].mean(axis=1)
    logs = np.log(mean / inside[:, None])
    holes = []
    for channel in counts.codes:
        seen = np.flatnonzero(channel)
        around = np.convolve(channel, np.ones(5) / 5.0, "same")
        span = slice(seen[0], seen[-1] + 1) if seen.size else slice(None)
        holes.append(float((channel[span] < 0.2 * around[span]).mean()))
    return np.array([*logs[:, -1], *logs[:, 3], *np.log(inside), logs.std(), *holes])


def _exposure(counts: NoiseCounts) -> Float:
    """Quantiles of green in the windows, shares of each channel that are clipped, and means.

    What auto-exposure tells: where a photo's middle lies, and how much of it is white or black.
    """
    green = np.cumsum(counts.codes[1]) / max(float(counts.codes[1].sum()), 1.0)
    quantiles = np.searchsorted(green, EXPOSURE_QUANTILES) / 255.0
    share = counts.codes / np.maximum(counts.codes.sum(axis=1, keepdims=True), 1.0)
    white, black = share[:, _ALMOST_WHITE:].sum(axis=1), share[:, :_ALMOST_BLACK].sum(axis=1)
    mean = share @ (np.arange(256) / 255.0)
    return np.concatenate([quantiles, np.log(white + 1e-3), np.log(black + 1e-3), mean])


def _eyes(view: FaceView, skin: Float) -> Float | None:
    """Luma quantiles in the eyes, from pupil to sclera, beside those of skin (N, 3).

    None where they are closed or too small to be seen.
    """
    mask = np.zeros(view.encoded.shape[:2], np.uint8)
    for outline in (regions.RIGHT_EYE, regions.LEFT_EYE):
        hull = np.rint((view.geometry.vertices[list(outline), :2] - 0.5) * 16.0)
        cv2.fillPoly(mask, [hull.astype(np.int32)], 1, shift=4)
    if _opening(view.geometry.vertices) < _CLOSED:
        return None
    inside = _colors(view, mask > 0)
    if len(inside) < _MIN_EYE_PIXELS:
        return None
    luma = _brightness(inside)
    quantiles = quantiles_of(luma, EYE_QUANTILES)
    bright = inside[luma >= quantiles[-2]].mean(axis=0)
    middle = quantiles_of(_brightness(skin), (0.1, 0.5, 0.9))
    return np.array([*quantiles, *bright, *middle])


def _opening(vertices: Float) -> float:
    """Height over width of the wider opened eye, of the face's vertices (V, 3)."""
    ratios = []
    for outer, inner, upper, lower in (_RIGHT_LIDS, _LEFT_LIDS):
        width = float(np.linalg.norm(vertices[outer, :2] - vertices[inner, :2]))
        height = float(np.linalg.norm(vertices[upper, :2] - vertices[lower, :2]))
        ratios.append(height / max(width, 1e-6))
    return max(ratios)


def resampled(
    skin: npt.NDArray[np.bool_], frame: tuple[float, float, float, float], window: Window
) -> npt.NDArray[np.bool_]:
    """A mask at working size as the pixels of one window of the photo have it.

    Parameters
    ----------
    skin
        (H, W) at working size.
    frame
        x and y of its upper left corner, and its width and height, in pixels of the photo.
    window
        Of the photo.
    """
    left, top, width, height = frame
    rows, columns = (
        (np.arange(part.start, part.stop) + 0.5 - begin) * count / size
        for part, begin, size, count in (
            (window[0], top, height, skin.shape[0]),
            (window[1], left, width, skin.shape[1]),
        )
    )
    inside = np.zeros((rows.size, columns.size), bool)
    r, c = (
        np.flatnonzero((p >= 0) & (p < n)) for p, n in zip((rows, columns), skin.shape, strict=True)
    )
    if r.size and c.size:
        there = skin.take(rows[r].astype(np.intp), axis=0).take(columns[c].astype(np.intp), axis=1)
        inside[r[0] : r[-1] + 1, c[0] : c[-1] + 1] = there  # what is inside is in one piece
    return inside
