"""The paper's figures, drawn from what was computed for them."""

from __future__ import annotations

from io import BytesIO

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import hsv_to_rgb
from matplotlib.figure import Figure

from facecrf_ocio.benchmark.energy_profiles import Comparison, Profile
from facecrf_ocio.plots.calibration_plot import (
    BLACK,
    HEMOGLOBIN_COLOR,
    HUE_RANGE,
    MELANIN_COLOR,
    blank,
    dimmed_face,
    pair_positions,
)
from facecrf_ocio.published.face_estimator import AnalyzedFace
from facecrf_ocio.values import CHANNELS, Float

DOTS_PER_INCH = 200  # enough for print; chosen by judgment
_TRUTH_COLOR = "#00b4ff"
_BEST_COLOR = "#ffffff"


def png(figure: Figure) -> bytes:
    """Return a figure as a PNG file; the same figure gives the same bytes."""
    content = BytesIO()
    figure.savefig(content, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None})
    return content.getvalue()


def profile_figure(profile: Profile, photo_label: str, candidate_label: str) -> Figure:
    """Fig. 2 (c) and 3 (c): E_p and E over candidates and photos, each photo from 0 to 1."""
    figure = blank(13.0, 4.4)
    energies = (
        (profile.pigment, "$E_p$, exact log ratios"),
        (profile.printed, "$E_p$ as printed (eq. 15)"),
        (profile.total, "$E$"),
    )
    for axes, (energy, name) in zip(figure.subplots(1, 3), energies, strict=True):
        _draw_profile(axes, profile, energy)
        varies = np.nanmedian(np.ptp(energy, axis=0) / np.abs(energy).max(axis=0))
        axes.set(xlabel=photo_label, ylabel=candidate_label)
        axes.set_title(f"{name}\nrange of a column: {100 * varies:.2g} %")
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    return figure


def face_figure(analyzed: AnalyzedFace, half_width: float) -> Figure:
    """Fig. 4: the skin, the single-pigment map C over it, and the histogram of hues."""
    figure = blank(11.0, 4.2)
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
    pairs.legend(loc="lower center", fontsize="small", ncols=2, handletextpad=0.1)
    for axes in (face, pairs):
        axes.set_axis_off()
    _draw_hues(hues, analyzed, half_width)
    return figure


def curves_figure(comparisons: tuple[Comparison, ...]) -> Figure:
    """Fig. 7 and 8: a row for each photo: the photo, then all curves in R, G and B."""
    figure = blank(13.0, 3.2 * len(comparisons) + 0.6)
    rows = figure.subplots(len(comparisons), 4, squeeze=False)
    for row, comparison in zip(rows, comparisons, strict=True):
        row[0].imshow(comparison.photo.encoded)
        row[0].set_axis_off()
        row[0].set_title(comparison.name, fontsize="medium", parse_math=False)
        for channel in range(3):
            _draw_curves(row[1 + channel], comparison, channel)
    handles, labels = rows[0, 1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(8, len(labels)))
    return figure


def _draw_profile(axes: Axes, profile: Profile, energy: Float) -> None:
    known = np.isfinite(energy).all(axis=0)
    low, high = energy.min(axis=0), energy.max(axis=0)
    scaled = (energy - low) / np.where(high > low, high - low, 1.0)
    axes.pcolormesh(profile.photos, profile.candidates, scaled, cmap="inferno", shading="nearest")
    axes.plot(
        profile.photos, profile.truth, color=_TRUTH_COLOR, linestyle="--", linewidth=1.5,
        label="truth",
    )  # fmt: skip
    best = profile.candidates[np.argmin(energy[:, known], axis=0)]
    axes.plot(
        profile.photos[known], best, "o", color=_BEST_COLOR, markeredgecolor="black",
        markersize=5, label="minimum",
    )  # fmt: skip


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
    axes.set_xlabel(f"hue, degrees from its mode P = {mode:.0f}; dotted: $\\omega$")
    axes.set_title("(c) hues of the region")


def _draw_curves(axes: Axes, comparison: Comparison, channel: int) -> None:
    colors = colormaps["tab20"].colors  # type: ignore[attr-defined]
    for index, estimate in enumerate(comparison.estimates):
        color = colors[index % len(colors)]
        if estimate.found is None:
            axes.plot([], [], color=color, label=estimate.estimator)
            continue
        curve = estimate.found
        axes.plot(curve.encoded, curve.linear[channel], color=color, label=estimate.estimator)
    grid = np.linspace(0.0, 1.0, comparison.truth.shape[1])
    axes.plot(
        grid, comparison.truth[channel], color="black", linestyle="--", linewidth=2, label="truth"
    )
    refused = [e.estimator for e in comparison.estimates if e.found is None]
    if refused and channel == 0:
        axes.text(0.03, 0.97, "refused:\n" + "\n".join(refused), va="top", fontsize="x-small")
    axes.set(xlim=(0, 1), ylim=(0, 1), title=CHANNELS[channel])
    axes.grid(color="0.92")
