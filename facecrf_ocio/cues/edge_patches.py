"""Edge patches: windows in which two uniform colors meet and blend (Lin et al., CVPR 2004, sec. 4).

Pixels are taken as the file has them. A photo must not be scaled down to make the search faster:
averages of *encoded* values are blends too, and they are straight in the wrong space.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.cues.evidence import Lacking
from facecrf_ocio.energy.color_blend import EdgeBlends
from facecrf_ocio.values import Float, Index, Photo

WINDOW = 15
CANNY_THRESHOLDS = (50.0, 100.0)
EDGE_BAND = 5
SPACING = 7
MAX_WINDOWS = 20_000
MIN_REGION_SHARE = 0.15
MAX_DEVIATION = 10.0 / 255.0
MIN_CONTRAST = 25.0 / 255.0
MIN_CONTRAST_TO_DEVIATION = 8.0
MIN_HUE_CONTRAST = 10.0 / 255.0
CLIPPED_MARGIN = 0.5 / 255.0
BLEND_MARGIN = 0.06
TOLERANCE = 1.5 / 255.0
MIN_BLENDS = 3
MAX_BLENDS = 12
MIN_PATCHES = 10

Labels = npt.NDArray[np.int32]


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
    band = cv2.dilate(edges, np.ones((EDGE_BAND, EDGE_BAND), np.uint8))
    corners, labels = _two_region_windows(edges, band, _candidate_corners(edges))
    patches = [
        patch
        for corner, label in zip(corners, labels, strict=True)
        if (patch := _examine(encoded, corner, label)) is not None
    ]
    return _without_overlap(sorted(patches, key=_quality, reverse=True))


def gather_blends(patches: list[EdgePatch]) -> EdgeBlends:
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
            "use a color version, or --fallback mean",
        )
    if count < MIN_PATCHES:
        return Lacking(
            f"the photo shows too few clean edges between two uniform colors ({count}, "
            f"{MIN_PATCHES} are needed)",
            "use a sharp photo with flat, differently colored surfaces, not sharpened or scaled, "
            "or --fallback mean",
        )
    return None


def _quality(patch: EdgePatch) -> float:
    return patch.contrast / (patch.deviation + 1.0 / 255.0)


def _edge_map(encoded: npt.NDArray[np.float32]) -> npt.NDArray[np.uint8]:
    """Canny edges of the channel that changes most; 1 at an edge."""
    codes = cv2.convertScaleAbs(encoded, alpha=255.0)
    smooth = cv2.GaussianBlur(codes, (3, 3), 0.0)
    return np.asarray(cv2.Canny(smooth, *CANNY_THRESHOLDS) > 0, dtype=np.uint8)


def _candidate_corners(edges: npt.NDArray[np.uint8]) -> Index:
    """Corners (N, 2) as row and column of windows about edge pixels, one a cell of a grid.

    Where a photo has more than `MAX_WINDOWS`, every n-th is kept.
    """
    half = WINDOW // 2
    length = cv2.boxFilter(edges, cv2.CV_16S, (WINDOW, WINDOW), normalize=False)
    inner = (edges > 0) & (length >= WINDOW - 2) & (length <= 2 * WINDOW)
    rows, columns = np.nonzero(inner[half:-half, half:-half])
    cells = (rows // SPACING) * edges.shape[1] + columns // SPACING
    _, first = np.unique(cells, return_index=True)
    stride = -(-len(first) // MAX_WINDOWS) if len(first) else 1
    chosen = first[::stride]
    return np.stack([rows[chosen], columns[chosen]], axis=1)


def _two_region_windows(
    edges: npt.NDArray[np.uint8], band: npt.NDArray[np.uint8], corners: Index
) -> tuple[list[tuple[int, int]], list[Labels]]:
    """Windows that one edge crosses and parts into two regions of some size, with their labels."""
    kept, labels = [], []
    outside = 1 - band
    for row, column in corners.tolist():
        window = np.s_[row : row + WINDOW, column : column + WINDOW]
        if not _crossed_once(edges[window]):
            continue
        count, label = cv2.connectedComponents(outside[window], connectivity=4)
        if count == 3 and np.bincount(label.ravel())[1:].min() >= MIN_REGION_SHARE * WINDOW**2:
            kept.append((row, column))
            labels.append(label)
    return kept, labels


def _crossed_once(edges: npt.NDArray[np.uint8]) -> bool:
    """Whether an edge enters the window at one place and leaves it at one other.

    A third edge that joins within the band would hide a third color among the blends.
    """
    ring = np.concatenate([edges[0, :-1], edges[:-1, -1], edges[-1, :0:-1], edges[:0:-1, 0]])
    entries = int(((ring == 1) & (np.roll(ring, 1) == 0)).sum())
    return entries == 2


def _examine(
    encoded: npt.NDArray[np.float32], corner: tuple[int, int], label: Labels
) -> EdgePatch | None:
    """The patch of one window, or None where a test fails."""
    row, column = corner
    window = encoded[row : row + WINDOW, column : column + WINDOW].astype(np.float64)
    if window.max() >= 1.0 - CLIPPED_MARGIN or window.min() < 0.0:
        return None
    sides = [window[label == 1], window[label == 2]]
    regions = np.array([side.mean(axis=0) for side in sides])
    deviation = max(float(side.std(axis=0).max()) for side in sides)
    if not _differ(regions, deviation):
        return None
    blends = _blended_pixels(window[label == 0], regions, deviation)
    if blends is None:
        return None
    return EdgePatch((column, row), regions, deviation, blends)


def _differ(regions: Float, deviation: float) -> bool:
    """Whether two uniform regions have colors far enough apart, and not both neutral."""
    contrast = float(np.linalg.norm(regions[1] - regions[0]))
    return (
        deviation <= MAX_DEVIATION
        and contrast >= max(MIN_CONTRAST, MIN_CONTRAST_TO_DEVIATION * deviation)
        and float(np.ptp(regions, axis=1).max()) >= MIN_HUE_CONTRAST
    )


def _blended_pixels(pixels: Float, regions: Float, deviation: float) -> Float | None:
    """Edge pixels between the region colors, in order; None where they are no blend."""
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
    """Whether no channel falls back while the leading channel goes on."""
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
