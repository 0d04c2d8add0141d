"""Edge patches: windows in which two uniform colors meet and blend (Lin et al., CVPR 2004, sec. 4).

Pixels are taken as the file has them. A photo must not be scaled down to make the search faster:
averages of *encoded* values are blends too, and they are straight in the wrong space.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.published.energy.color_blend import EdgeBlends
from facecrf_ocio.values import Bool, Float, Index, Lacking, Photo

# The paper gives the size of the window and names the tests; their thresholds are ours.
WINDOW = 15
CANNY_THRESHOLDS = (
    50.0,
    100.0,
)  # [8-bit code] of gradients: that continues an edge, that begins one
SPACING = 7  # [px] cell of which one window is tried: half a window, so that few overlap
BAND_ROWS = 64 * SPACING  # [px] whole cells
MAX_WINDOWS = 12_000  # bounds the time that a photo full of edges takes
CHUNK = 2048  # windows held in memory at once, 11 MB of them
EDGE_BANDS = (5, 9)  # [px] width left out about the edge: that of a sharp photo, then of a soft one
MIN_REGION_SHARE = 0.15  # of the window, for either region
MAX_DEVIATION = 10.0 / 255.0  # [encoded] within a region that counts as uniform
MIN_CONTRAST = 25.0 / 255.0  # [encoded] distance of the regions' colors
MIN_CONTRAST_TO_DEVIATION = 8.0  # or the blends would drown in noise
# [encoded] largest less smallest channel: gray blends lie on a line anyhow.
MIN_HUE_CONTRAST = 10.0 / 255.0
CLIPPED_MARGIN = 0.5 / 255.0  # [encoded] half an 8-bit code below white
# Of the way from color to color: nearer to either, a pixel is the region itself.
BLEND_MARGIN = 0.06
# [encoded] by which a blend may leave the range of both colors: 1.5 8-bit codes.
TOLERANCE = 1.5 / 255.0
MIN_BLENDS = 3  # pixels of a patch, or it tells next to nothing of the way between
MAX_BLENDS = 12  # pixels of a patch, or long edges would outweigh many short ones
MIN_PATCHES = 10  # of a photo, or it is refused

# Edge pixels at the border may hold light of a third color that lies just outside of the window.
INNER = np.s_[2:-2, 2:-2]

Mask = npt.NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class EdgePatch:
    """One window that passed every test.

    Attributes
    ----------
    corner_xy
        Top left pixel of the window of `WINDOW` pixels.
    regions
        (2, 3) mean encoded colors of both regions.
    deviation
        Largest standard deviation of encoded values within a region.
    blends
        (T, 3) encoded colors of edge pixels between them, from the first region to the second.
    """

    corner_xy: tuple[int, int]
    regions: Float
    deviation: float
    blends: Float

    @property
    def contrast(self) -> float:
        """Distance of the two region colors, encoded."""
        return float(np.linalg.norm(self.regions[1] - self.regions[0]))


def find_edge_patches(encoded: npt.NDArray[np.float32]) -> list[EdgePatch]:
    """Find windows whose edge pixels blend two uniform colors.

    A window is centered on a Canny edge pixel and holds one edge, which parts it into two regions.
    Both are uniform, their colors differ, and neither is clipped. The edge pixels stay in the
    range of the two colors and pass from one to the other in step in all channels, as a blend
    does under any increasing response. Neutral edges say nothing and are left out.

    Parameters
    ----------
    encoded
        (H, W, 3) in [0, 1].

    Returns
    -------
    list
        Windows that do not overlap, those with the strongest contrast for their noise first.
    """
    if min(encoded.shape[:2]) < WINDOW:
        return []
    edges = _edge_map(encoded)
    corners = _crossed_once(edges, _candidate_corners(edges))
    patches: dict[tuple[int, int], EdgePatch] = {}
    for width in EDGE_BANDS:
        band = np.asarray(cv2.dilate(edges, np.ones((width, width))), dtype=np.uint8)
        left = np.array([c for c in corners.tolist() if tuple(c) not in patches], dtype=np.intp)
        found, labels = _two_region_windows(band, left.reshape(-1, 2))
        for start in range(0, len(found), CHUNK):
            part = slice(start, start + CHUNK)
            for patch in _examine(encoded, found[part], labels[part]):
                patches[patch.corner_xy[::-1]] = patch
    return _without_overlap(sorted(patches.values(), key=_quality, reverse=True))


def stack_blends(patches: list[EdgePatch]) -> EdgeBlends:
    """Colors of all patches in the arrays that the energies take."""
    counts = [len(patch.blends) for patch in patches]
    return EdgeBlends(
        np.array([patch.regions for patch in patches]).transpose(2, 0, 1),
        np.concatenate([patch.blends for patch in patches]).T,
        np.repeat(np.arange(len(patches)), counts),
    )


def lacking_patches(photo: Photo, count: int) -> Lacking | None:
    """Why a photo with so many edge patches cannot be calibrated by them; None where it can."""
    if photo.grayscale:
        return Lacking(
            "the photo is grayscale, and color blends show only in color",
            "use a color version",
        )
    if count < MIN_PATCHES:
        return Lacking(
            f"the photo shows too few clean edges between two uniform colors ({count} found, "
            f"{MIN_PATCHES} are needed)",
            "use a sharp photo of flat, differently colored surfaces that was not sharpened or "
            "scaled",
        )
    return None


def _quality(patch: EdgePatch) -> float:
    return patch.contrast / (patch.deviation + 1.0 / 255.0)


def _edge_map(encoded: npt.NDArray[np.float32]) -> Mask:
    """(H, W) Canny edges of the channel that changes most; 1 at an edge."""
    codes = cv2.convertScaleAbs(encoded, alpha=255.0)
    smooth = cv2.GaussianBlur(codes, (3, 3), 0.0)
    return np.asarray(cv2.Canny(smooth, *CANNY_THRESHOLDS) > 0, dtype=np.uint8)


def _candidate_corners(edges: Mask) -> Index:
    """Rows and columns (N, 2) of windows about edge pixels, one for each cell of a grid.

    Where a photo has more than `MAX_WINDOWS`, every n-th is kept.
    """
    half = WINDOW // 2
    length = cv2.boxFilter(edges, cv2.CV_16S, (WINDOW, WINDOW), normalize=False)
    inner = (edges > 0) & (length >= WINDOW - 2) & (length <= 2 * WINDOW)
    inner = inner[half:-half, half:-half]
    # Whole rows of cells at a time: positions take 20 times the memory of the map itself.
    corners = np.concatenate(
        [
            _first_of_each_cell(inner[top : top + BAND_ROWS]) + np.array([top, 0])
            for top in range(0, len(inner), BAND_ROWS)
        ]
    )
    return np.asarray(corners[:: max(1, -(-len(corners) // MAX_WINDOWS))])


def _first_of_each_cell(inner: Bool) -> Index:
    """The first marked pixel of each cell, rows and columns (N, 2)."""
    rows, columns = np.nonzero(inner)
    cells = (rows // SPACING) * inner.shape[1] + columns // SPACING
    _, first = np.unique(cells, return_index=True)
    return np.stack([rows[first], columns[first]], axis=1)


def _crossed_once(edges: Mask, corners: Index) -> Index:
    """Windows, by corners (N, 2) [row, column], that an edge enters once and leaves once.

    A third edge that joins within the band would hide a third color among the blends.
    """
    side, end = np.arange(WINDOW - 1), WINDOW - 1
    zero, last = np.zeros_like(side), np.full_like(side, end)
    row = np.concatenate([zero, side, last, end - side])
    column = np.concatenate([side, last, end - side, zero])
    ring = edges[corners[:, :1] + row, corners[:, 1:] + column]
    entries = ((ring == 1) & (np.roll(ring, 1, axis=1) == 0)).sum(axis=1)
    return np.asarray(corners[entries == 2])


def _two_region_windows(band: Mask, corners: Index) -> tuple[Index, npt.NDArray[np.int32]]:
    """Windows that the edge band parts into two regions of some size, and labels (N, W, W)."""
    outside = 1 - band
    kept, labels = [], []
    for row, column in corners.tolist():
        window = outside[row : row + WINDOW, column : column + WINDOW]
        count, label = cv2.connectedComponents(window, connectivity=4)
        if count == 3:
            kept.append((row, column))
            labels.append(label)
    found = np.array(labels, dtype=np.int32).reshape(-1, WINDOW, WINDOW)
    sizes = np.stack([(found == side).sum(axis=(1, 2)) for side in (1, 2)])
    large = sizes.min(axis=0) >= MIN_REGION_SHARE * WINDOW**2
    return np.array(kept, dtype=np.intp).reshape(-1, 2)[large], found[large]


def _examine(
    encoded: npt.NDArray[np.float32], corners: Index, labels: npt.NDArray[np.int32]
) -> list[EdgePatch]:
    """Patches of the windows whose regions and edge pixels pass the tests.

    `corners` (N, 2) [row, column]; `labels` (N, 15, 15) of regions, 0 at edge pixels.
    """
    offset = np.arange(WINDOW)
    rows = corners[:, :1, None] + offset[:, None]
    columns = corners[:, 1:, None] + offset
    windows = encoded[rows, columns].astype(np.float64)
    regions, deviations = _region_statistics(windows, labels)
    patches = []
    for n in np.flatnonzero(_usable(windows, regions, deviations)):
        deviation = float(deviations[n])
        edge_pixels = windows[n][INNER][labels[n][INNER] == 0]
        blends = _blended_pixels(edge_pixels, regions[n], deviation)
        if blends is not None:
            row, column = corners[n].tolist()
            patches.append(EdgePatch((column, row), regions[n], deviation, blends))
    return patches


def _region_statistics(windows: Float, labels: npt.NDArray[np.int32]) -> tuple[Float, Float]:
    """Mean colors (N, 2, 3) of both regions, and the largest standard deviation (N,) in either."""
    sides = np.stack([labels == 1, labels == 2], axis=1).astype(np.float64)
    shares = sides / sides.sum(axis=(2, 3), keepdims=True)
    means = np.einsum("nsyx,nyxc->nsc", shares, windows)
    variances = np.einsum("nsyx,nyxc->nsc", shares, windows**2) - means**2
    return means, np.sqrt(np.maximum(variances, 0.0)).max(axis=(1, 2), initial=0.0)


def _usable(windows: Float, regions: Float, deviations: Float) -> Bool:
    """Windows (N,) of two uniform, unclipped regions of distinct colors, not both neutral."""
    contrast = np.linalg.norm(regions[:, 1] - regions[:, 0], axis=1)
    return np.asarray(
        (windows.max(axis=(1, 2, 3), initial=0.0) < 1.0 - CLIPPED_MARGIN)
        & (deviations <= MAX_DEVIATION)
        & (contrast >= np.maximum(MIN_CONTRAST, MIN_CONTRAST_TO_DEVIATION * deviations))
        & (np.ptp(regions, axis=2).max(axis=1, initial=0.0) >= MIN_HUE_CONTRAST)
    )


def _blended_pixels(pixels: Float, regions: Float, deviation: float) -> Float | None:
    """Edge pixels (N, 3) between region colors (2, 3), in order; None where they are no blend."""
    tolerance = max(TOLERANCE, 3.0 * deviation)
    low, high = regions.min(axis=0) - tolerance, regions.max(axis=0) + tolerance
    if ((pixels < low) | (pixels > high)).any():
        return None
    lead = int(np.argmax(np.abs(regions[1] - regions[0])))
    position = (pixels[:, lead] - regions[0, lead]) / (regions[1, lead] - regions[0, lead])
    mixed = (position > BLEND_MARGIN) & (position < 1.0 - BLEND_MARGIN)
    order = np.argsort(position[mixed], kind="stable")
    blends = pixels[mixed][order]
    if len(blends) < MIN_BLENDS or not _in_step(blends, regions, tolerance):
        return None
    spread = np.unique(np.linspace(0, len(blends) - 1, MAX_BLENDS).round().astype(np.intp))
    return np.asarray(blends[spread])


def _in_step(blends: Float, regions: Float, tolerance: float) -> bool:
    """Whether no channel of blends (N, 3) falls back while the leading channel goes on."""
    forward = blends * np.sign(regions[1] - regions[0])
    fallback = np.maximum.accumulate(forward, axis=0) - forward
    return float(fallback.max()) <= 2.0 * tolerance


def _without_overlap(patches: list[EdgePatch]) -> list[EdgePatch]:
    """Earlier patches win over later ones that share pixels with them."""
    taken: dict[tuple[int, int], list[tuple[int, int]]] = {}
    kept = []
    for patch in patches:
        x, y = patch.corner_xy
        near = [
            other
            for i in (-1, 0, 1)
            for j in (-1, 0, 1)
            for other in taken.get((x // WINDOW + i, y // WINDOW + j), [])
        ]
        if all(abs(x - a) >= WINDOW or abs(y - b) >= WINDOW for a, b in near):
            taken.setdefault((x // WINDOW, y // WINDOW), []).append((x, y))
            kept.append(patch)
    return kept
