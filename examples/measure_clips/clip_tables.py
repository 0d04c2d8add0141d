"""The table of clips."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.laid_out import csv_table, markdown_table, number
from facecrf_ocio.benchmark.tables import mean_of
from facecrf_ocio.files.atomic import Draft, write_files

_HEADINGS = (
    "|clips|stops: clip|a frame|ratio|mean curve|sRGB|RMSE: clip|a frame|ratio|mean curve|sRGB|"
    "band %|in stops %|a frame's %|alike near|far|each ratio|drifts told|noise used"
)
LEGEND = """\
Medians over clips; the error of a frame is the mean over those that the clip's curve comes from.
Stops: |log2(g / truth)| over codes 64 to 235 with one factor taken out at code 128. RMSE: of
g x 100 on 1,024 codes. ratio: of the medians. band: share of codes within the 90 % band. alike:
correlation of the errors of two frames of a clip, next to each other among those that are used and
more than half the clip apart. each ratio: geometric mean of the clips' own ratios. drifts told:
clips of which it was said that their curve drifts. noise used: clips whose noise told the
exponent."""


@dataclass(frozen=True, slots=True)
class ClipResult:
    """What came of one clip.

    Attributes
    ----------
    cell, image, response
        The clip.
    frames
        From which its curve comes.
    clip_mid, clip_rmse, frame_mid, frame_rmse, mean_mid, mean_rmse, srgb_mid, srgb_rmse
        Errors of the clip's curve, of its frames' on average, and of the trivial answers.
    band, band_stops, frame_band
        Shares of codes within the 90 % band, of the clip in linear light and in stops, and of its
        frames.
    drift, drift_error, drifts, true_drift
        What was said of it, and what is true.
    near, far, whole
        Mean product of the errors of frames next to each other and far apart, and mean square.
    exposure_stops
        By how much the face's light was found to vary.
    noise_told
        Whether noise told the exponent.
    """

    cell: str
    image: str
    response: str
    frames: int
    clip_mid: float
    clip_rmse: float
    frame_mid: float
    frame_rmse: float
    mean_mid: float
    mean_rmse: float
    srgb_mid: float
    srgb_rmse: float
    band: float | None
    band_stops: float | None
    frame_band: float
    drift: float
    drift_error: float
    drifts: bool
    true_drift: float
    near: float
    far: float
    whole: float
    exposure_stops: float
    noise_told: bool


def correlations(results: Sequence[ClipResult]) -> tuple[float, float]:
    """Of the errors of two frames of one clip that are near, and that are far from each other."""
    whole = max(float(np.sum([one.whole for one in results])), 1e-12)
    near, far = (float(np.sum(of)) for of in zip(*((r.near, r.far) for r in results), strict=True))
    return near / whole, far / whole


def clip_markdown(results: Sequence[ClipResult]) -> str:
    """The table, and what its columns mean."""
    names = dict.fromkeys(one.cell for one in results)
    rows = [[name, *_cells([r for r in results if r.cell == name])] for name in names]
    still = [one for one in results if not one.true_drift]
    rows.append(["all without drift", *_cells(still)] if still else rows[0])
    return markdown_table(_HEADINGS.split("|"), rows) + "\n\n" + LEGEND + "\n"


def clip_files(results: Sequence[ClipResult], output: Path) -> tuple[str, tuple[Path, ...]]:
    """Write `clips.md` and `clips.csv`; returns the table and the files."""
    text = clip_markdown(results)
    contents = {
        "clips.md": text.encode(),
        "clips.csv": csv_table([asdict(one) for one in results]),
    }
    drafts = [Draft(output / name, content, lambda _: None) for name, content in contents.items()]
    return text, write_files(drafts, overwrite=True)


def _cells(group: Sequence[ClipResult]) -> list[str]:
    def median(of: Callable[[ClipResult], float]) -> float:
        return float(np.nanmedian([of(one) for one in group]))

    clip, frame = median(lambda r: r.clip_mid), median(lambda r: r.frame_mid)
    clip_rmse, frame_rmse = median(lambda r: r.clip_rmse), median(lambda r: r.frame_rmse)
    return [
        str(len(group)),
        *(f"{value:.3f}" for value in (clip, frame)),
        f"{clip / frame:.2f}",
        *(f"{median(of):.3f}" for of in (lambda r: r.mean_mid, lambda r: r.srgb_mid)),
        *(f"{100.0 * value:.1f}" for value in (clip_rmse, frame_rmse)),
        f"{clip_rmse / frame_rmse:.2f}",
        *(f"{100.0 * median(of):.1f}" for of in (lambda r: r.mean_rmse, lambda r: r.srgb_rmse)),
        number(mean_of(r.band for r in group), 100, 0),
        number(mean_of(r.band_stops for r in group), 100, 0),
        number(mean_of(r.frame_band for r in group), 100, 0),
        *(f"{one:.2f}" for one in correlations(group)),
        f"{np.exp(np.nanmean([np.log(r.clip_mid / r.frame_mid) for r in group])):.2f}",
        f"{sum(r.drifts for r in group)} of {len(group)}",
        f"{sum(r.noise_told for r in group)} of {len(group)}",
    ]
