"""The paper's figures, drawn from what was computed for them."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy as np
from matplotlib import colormaps, rc_context
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import hsv_to_rgb
from matplotlib.figure import Figure

from facecrf_ocio.benchmark.energy_profiles import Comparison, Profile
from facecrf_ocio.estimators import FIXED_CURVES
from facecrf_ocio.plots.calibration_plot import (
    BLACK,
    HEMOGLOBIN_COLOR,
    HUE_RANGE,
    MELANIN_COLOR,
    blank,
    dimmed_face,
    pair_positions,
)
from facecrf_ocio.plots.seen import draw_seen, name_unseen, seen_codes
from facecrf_ocio.published.face_estimator import AnalyzedFace
from facecrf_ocio.values import CHANNELS, Float

DOTS_PER_INCH = 300  # as journals ask of print
PAGE_WIDTH = 7.2  # [inch] two columns and their gap, so that letters print as large as they are set
_STYLE: Any = {
    **{f"{what}.labelsize": 8.0 for what in ("axes", "xtick", "ytick")},
    "axes.titlesize": 8.5,
    "legend.fontsize": 8.0,
    "font.size": 8.0,  # [point]
}
_TRUTH_COLOR = "#00b4ff"
_BEST_COLOR = "#ffffff"


def png(figure: Figure) -> bytes:
    """Return a figure as a PNG file; the same figure gives the same bytes."""
    content = BytesIO()
    figure.savefig(content, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None})
    return content.getvalue()


@rc_context(_STYLE)
def profile_figure(profile: Profile, photo_label: str, candidate_label: str) -> Figure:
    """Fig. 2 (c) and 3 (c): E_p and E over candidates and photos, each photo from 0 to 1."""
    figure = blank(PAGE_WIDTH, 2.9)
    energies = (
        (profile.pigment, "$E_p$, exact log ratios"),
        (profile.printed, "$E_p$ as printed (eq. 15)"),
        (profile.total, "$E$"),
    )
    panels = figure.subplots(1, 3, sharey=True)
    for axes, (energy, name) in zip(panels, energies, strict=True):
        mesh = _draw_profile(axes, profile, energy)
        varies = np.nanmedian(np.ptp(energy, axis=0) / np.abs(energy).max(axis=0))
        axes.set(xlabel=photo_label)
        axes.set_title(f"{name}\nrange of a column: {100 * varies:.2g} %")
    panels[0].set_ylabel(candidate_label)
    bar = figure.colorbar(mesh, ax=panels, pad=0.01, aspect=30)
    bar.set_label("energy: 0 a column's least, 1 its most")
    handles, labels = panels[0].get_legend_handles_labels()
    legend = figure.legend(handles, labels, loc="outside lower center", ncols=2)
    legend.get_frame().set_facecolor("0.8")  # the white dots must be seen on it
    return figure


@rc_context(_STYLE)
def face_figure(analyzed: AnalyzedFace, half_width: float) -> Figure:
    """Fig. 4: the skin, the single-pigment map C over it, and the histogram of hues."""
    figure = blank(PAGE_WIDTH, 2.9)
    face, pairs, hues = figure.subplots(1, 3, width_ratios=[1, 1, 1.2])
    dimming = np.where(analyzed.view.geometry.bare_skin, 1.0, 0.35)[..., None]
    face.imshow(analyzed.view.encoded * dimming)
    face.set_title("(a) potential skin region F")
    pairs.imshow(dimmed_face(analyzed))
    melanin, hemoglobin = pair_positions(analyzed)
    for places, color, name in (
        (melanin, MELANIN_COLOR, "melanin only"),
        (hemoglobin, HEMOGLOBIN_COLOR, "hemoglobin only"),
    ):
        pairs.scatter(*places.T, s=12, color=color, edgecolors="black", linewidths=0.4, label=name)
    pairs.set_title("(b) diffuse skin and map C")
    pairs.legend(
        loc="lower center", fontsize="small", ncols=2, handletextpad=0.1, columnspacing=0.8
    )
    for axes in (face, pairs):
        axes.set_axis_off()
    _draw_hues(hues, analyzed, half_width)
    return figure


@rc_context(_STYLE)
def curves_figure(comparisons: tuple[Comparison, ...]) -> Figure:
    """Fig. 7 and 8: a row for each photo: the photo, then all curves in R, G and B."""
    figure = blank(PAGE_WIDTH, 2.0 * len(comparisons) + 0.8)
    rows = figure.subplots(len(comparisons), 4, squeeze=False, sharex="col")
    for row, comparison in zip(rows, comparisons, strict=True):
        row[0].imshow(comparison.photo.encoded)
        row[0].set_axis_off()
        row[0].set_title(comparison.name, fontsize="medium", parse_math=False)
        for channel in range(3):
            _draw_curves(row[1 + channel], comparison, channel)
        row[1].set_ylabel("linear light")
        for axes in row[2:]:
            axes.tick_params(labelleft=False)
    for axes in rows[-1, 1:]:
        axes.set_xlabel("encoded value")
    name_unseen(rows[0, 1], tuple(e for one in comparisons for e in one.estimates))
    handles, labels = rows[0, 1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure


def _draw_profile(axes: Axes, profile: Profile, energy: Float) -> QuadMesh:
    known = np.isfinite(energy).all(axis=0)
    low, high = energy.min(axis=0), energy.max(axis=0)
    scaled = (energy - low) / np.where(high > low, high - low, 1.0)
    mesh = axes.pcolormesh(
        profile.photos, profile.candidates, scaled, cmap="inferno", shading="nearest"
    )
    axes.plot(
        profile.photos, profile.truth, color=_TRUTH_COLOR, linestyle="--", linewidth=1.5,
        label="truth",
    )  # fmt: skip
    best = profile.candidates[np.argmin(energy[:, known], axis=0)]
    axes.plot(
        profile.photos[known], best, "o", color=_BEST_COLOR, markeredgecolor="black",
        markersize=3.5, markeredgewidth=0.6, label="minimum",
    )  # fmt: skip
    return mesh


def _draw_hues(axes: Axes, analyzed: AnalyzedFace, half_width: float) -> None:
    histogram, mode = analyzed.mask.hue_histogram, analyzed.mask.hue_mode
    width = 360.0 / histogram.size
    hues = (np.arange(histogram.size) + 0.5) * width
    offset = (hues - mode + 180.0) % 360.0 - 180.0
    near = np.abs(offset) <= HUE_RANGE
    colors = hsv_to_rgb(np.stack([hues / 360, np.full_like(hues, 0.75), np.ones_like(hues)], 1))
    axes.bar(offset[near], histogram[near] / histogram.max(), width, color=colors[near])
    for edge in (-half_width, half_width):
        axes.axvline(edge, color=BLACK, linewidth=1.0, linestyle=":")
    axes.set(xlim=(-HUE_RANGE, HUE_RANGE), ylabel="normalized frequency")
    axes.set_xlabel(f"hue, degrees from its mode,\nP = {mode:.0f} degrees; dotted: $\\omega$")
    axes.set_title("(c) hues of the region")


def _draw_curves(axes: Axes, comparison: Comparison, channel: int) -> None:
    grid = np.linspace(0.0, 1.0, comparison.truth.shape[1])
    axes.plot(grid, comparison.truth[channel], color="0.75", linewidth=4.0, label="truth")
    for estimate, line in zip(comparison.estimates, _lines(comparison), strict=True):
        if estimate.found is None:
            axes.plot([], [], **line)
            continue
        curve = estimate.found
        seen = seen_codes(estimate, channel)
        draw_seen(axes, curve.encoded, curve.linear[channel], seen, **line)
    refused = [e.estimator for e in comparison.estimates if e.found is None]
    if refused and channel == 0:
        axes.text(0.03, 0.97, "refused:\n" + "\n".join(refused), va="top", fontsize="x-small")
    axes.set(xlim=(0, 1), ylim=(0, 1), title=CHANNELS[channel], xticks=(0, 0.5, 1))
    axes.grid(color="0.92")


def _lines(comparison: Comparison) -> list[dict[str, Any]]:
    """How each estimate is drawn: fixed curves thin and dotted, what is estimated in colors."""
    colors = iter(colormaps["tab10"].colors)  # type: ignore[attr-defined]
    grays = iter(("0.1", "0.35", "0.5", "0.65"))
    names = [estimate.estimator for estimate in comparison.estimates]
    return [
        {"label": name, "color": next(grays), "linewidth": 1.0, "linestyle": ":"}
        if name in FIXED_CURVES
        else {"label": name, "color": next(colors), "linewidth": 1.2}
        for name in names
    ]
