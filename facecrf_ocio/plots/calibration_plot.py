"""One picture of a calibration: its curves, and the face it rests on (the paper's Fig. 4)."""

from __future__ import annotations

import textwrap
import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import hsv_to_rgb
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from facecrf_ocio.face.view import cut_face
from facecrf_ocio.files.atomic import Draft, write_files
from facecrf_ocio.plots.seen import draw_seen, name_unseen, seen_codes
from facecrf_ocio.published.face_estimator import AnalyzedFace, analyze_face
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.response.stops import (
    CODES,
    MID_GRAY,
    NINETY_PERCENT,
    SHADOW_CODES,
    log_light,
    uniform,
)
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import CHANNELS, Estimate, Float, Photo
from facecrf_ocio.wording.sentence import sentence
from facecrf_ocio.wording.trust_words import trust_phrase

INK = {"R": "#c8322b", "G": "#2f8f46", "B": "#2b5fc8"}
BLACK = "#202020"
MELANIN_COLOR = "#ffd800"
HEMOGLOBIN_COLOR = "#e4002b"
DIMMED = 0.35  # share of its light that what is no skin keeps
DOTS_PER_INCH = 150  # 2100 px for the widest picture, 14 inches
STOPS_SHOWN = 2.0
"""[stop] Most curves lie within this of sRGB from code 16 on."""
HUE_RANGE = 60.0
"""[degree] The histogram shows hues this far from the most frequent one."""


def write_plot(
    path: Path, photo: Photo, estimate: Estimate, settings: Settings, *, overwrite: bool = False
) -> Path:
    """Write the picture that `plot_draft` draws.

    Raises
    ------
    OutputError
        If the file exists and `overwrite` is false, or it cannot be written.
    """
    draft = plot_draft(path, photo, estimate, settings)
    return write_files([draft], overwrite=overwrite)[0]


def plot_draft(path: Path, photo: Photo, estimate: Estimate, settings: Settings) -> Draft:
    """Draw the curves with their bands, sRGB for comparison, and the first face, as PNG.

    Parameters
    ----------
    path
        Where it shall appear.
    photo, estimate, settings
        Of a calibration that found a curve.

    Returns
    -------
    Draft
        To be written by `write_files`, alone or together with other files.
    """
    analyzed = None
    if estimate.faces:
        analyzed = analyze_face(cut_face(photo, estimate.faces[0], settings), settings)
    if analyzed is None:
        figure = curves_only(estimate)
    else:
        figure = _with_face(estimate, analyzed, settings.hue_half_width)
    _draw_title(figure, photo, estimate)
    content = BytesIO()
    with warnings.catch_warnings():
        # A file's name may hold characters that the font lacks; they are drawn as boxes.
        warnings.filterwarnings("ignore", message=r"Glyph .* missing from font")
        figure.savefig(content, format="png", dpi=DOTS_PER_INCH)
    return Draft(path, content.getvalue(), lambda _: None)


def dimmed_face(analyzed: AnalyzedFace) -> npt.NDArray[np.float32]:
    """The face, dimmed outside of its diffuse skin.

    Returns
    -------
    numpy.ndarray
        (H, W, 3) float32 in [0, 1].
    """
    dimming = np.where(analyzed.mask.diffuse, 1.0, DIMMED)[..., None]
    return np.asarray(analyzed.view.encoded * dimming, dtype=np.float32)


def pair_positions(analyzed: AnalyzedFace) -> tuple[Float, Float]:
    """Where the single-pigment pairs lie, in pixels of the face's view.

    Returns
    -------
    tuple of numpy.ndarray
        (N, 2) x, y of the melanin-only pairs and (M, 2) of the hemoglobin-only ones, each the
        middle between a pair's two pixel centers, which lie at whole numbers.
    """
    rows, columns = np.nonzero(analyzed.mask.skin)
    pixels = np.stack([columns, rows], axis=1).astype(np.float64)
    middle = pixels[analyzed.gradients.pairs].mean(axis=1)
    is_melanin = analyzed.gradients.is_melanin
    return middle[is_melanin], middle[~is_melanin]


def blank(width: float, height: float) -> Figure:
    """Return an empty figure of that size in inches, bound to no window."""
    margins = ConstrainedLayoutEngine(w_pad=0.1, h_pad=0.1)
    figure = Figure(figsize=(width, height), layout=margins)
    FigureCanvasAgg(figure)
    return figure


def curves_only(estimate: Estimate) -> Figure:
    """Draw the curves of an estimate with their bands, and the same in stops above sRGB."""
    figure = blank(6.0, 9.0)
    axes = figure.subplot_mosaic([["curves"], ["stops"]], height_ratios=[2.4, 1.0])
    _draw_curves(axes["curves"], estimate)
    _draw_stops(axes["stops"], estimate)
    return figure


def _with_face(estimate: Estimate, analyzed: AnalyzedFace, half_width: float) -> Figure:
    figure = blank(14.0, 8.4)
    axes = figure.subplot_mosaic(
        [["curves", "face", "pairs"], ["stops", "hues", "hues"]],
        width_ratios=[1.35, 1.0, 1.0],
        height_ratios=[2.4, 1.0],
    )
    _draw_curves(axes["curves"], estimate)
    _draw_stops(axes["stops"], estimate)
    axes["face"].imshow(analyzed.view.encoded)
    axes["face"].set_title("face, as encoded")
    _draw_pairs(axes["pairs"], analyzed)
    _draw_hues(axes["hues"], analyzed, half_width)
    for name in ("face", "pairs"):
        axes[name].set_axis_off()
    return figure


def _draw_title(figure: Figure, photo: Photo, estimate: Estimate) -> None:
    name = "photo in memory" if photo.path is None else photo.path.name
    name = textwrap.shorten("".join(c if c.isprintable() else "?" for c in name), 60)
    told = estimate.confidence
    verdict = "" if told is None else f" ({trust_phrase(told)})"
    # Half an inch takes about six letters of this size.
    width = int(figure.get_figwidth() * 12)
    reason = "\n".join(textwrap.wrap(f"{estimate.outcome}{verdict}: {sentence(estimate)}", width))
    figure.suptitle(f"{name}\n{reason}", fontsize=11, parse_math=False)


def _draw_curves(axes: Axes, estimate: Estimate) -> None:
    curve = estimate.curve
    srgb = fixed_curve("srgb", curve.encoded, dorf_model())
    axes.plot(curve.encoded, srgb, color="0.45", linestyle=":", linewidth=1.6, label="sRGB")
    if (curve.linear == curve.linear[0]).all():
        _draw_curve(axes, estimate, 0, BLACK, "R = G = B")
    else:
        for index, channel in enumerate(CHANNELS):
            _draw_curve(axes, estimate, index, INK[channel], channel)
    name_unseen(axes, (estimate,))
    axes.set(
        xlabel="encoded value (1: white)",
        ylabel="linear light (1: white)",
        xlim=(0, 1),
        ylim=(0, 1),
        aspect="equal",
    )
    axes.set_title("inverse camera response")
    axes.grid(color="0.9")
    axes.legend(loc="upper left")


def _draw_curve(axes: Axes, estimate: Estimate, index: int, color: str, label: str) -> None:
    encoded, linear = estimate.curve.encoded, estimate.curve.linear[index]
    confidence = estimate.confidence
    if confidence is not None and confidence.sigma[index].any():
        half = NINETY_PERCENT * confidence.sigma[index]
        low, high = np.clip([linear - half, linear + half], 0.0, 1.0)
        axes.fill_between(encoded, low, high, color=color, alpha=0.12, linewidth=0)
        label = f"{label}, 90 % band"
    seen = seen_codes(estimate, index)
    draw_seen(axes, encoded, linear, seen, color=color, linewidth=1.8, label=label)


def _draw_stops(axes: Axes, estimate: Estimate) -> None:
    """How many stops the curve lies above sRGB decoding, one factor taken out at mid-gray."""
    srgb = log_light(fixed_curve("srgb", CODES / CODES[-1], dorf_model()))
    above = log_light(uniform(estimate.curve)) - srgb
    told = estimate.confidence
    alike = bool((estimate.curve.linear == estimate.curve.linear[0]).all())
    for index, channel in enumerate(CHANNELS[:1] if alike else CHANNELS):
        color = BLACK if alike else INK[channel]
        if told is not None and told.in_stops is not None:
            half = NINETY_PERCENT * told.in_stops.sigma[index]
            low, high = above[index] - half, above[index] + half
            axes.fill_between(CODES, low, high, color=color, alpha=0.12, linewidth=0)
        seen = np.interp(CODES / CODES[-1], estimate.curve.encoded, seen_codes(estimate, index))
        draw_seen(
            axes,
            np.asarray(CODES, np.float64),
            above[index],
            seen > 0.5,
            color=color,
            linewidth=1.8,
        )
    axes.axhline(0.0, color="0.45", linestyle=":", linewidth=1.6)
    axes.axvline(MID_GRAY, color="0.8", linewidth=1.0)
    axes.set(xlim=(SHADOW_CODES[0], CODES[-1]), ylim=(-STOPS_SHOWN, STOPS_SHOWN))
    axes.set(xlabel="8-bit code", ylabel="stops above sRGB")
    axes.set_title("in stops, equal at code 128; 90 % band", fontsize="medium")
    axes.grid(color="0.9")


def _draw_pairs(axes: Axes, analyzed: AnalyzedFace) -> None:
    axes.imshow(dimmed_face(analyzed))
    melanin, hemoglobin = pair_positions(analyzed)
    for places, color, pigment in (
        (melanin, MELANIN_COLOR, "melanin"),
        (hemoglobin, HEMOGLOBIN_COLOR, "hemoglobin"),
    ):
        axes.scatter(
            places[:, 0],
            places[:, 1],
            s=16.0,
            color=color,
            edgecolors="black",
            linewidths=0.5,
            label=f"{pigment} only ({len(places)})",
        )
    axes.set_title("diffuse skin, single-pigment pairs")
    axes.legend(loc="lower center", ncols=2, fontsize="small", handletextpad=0.2)


def _draw_hues(axes: Axes, analyzed: AnalyzedFace, half_width: float) -> None:
    """Draw the histogram around its mode, and the window of hues taken for skin."""
    mask = analyzed.mask
    width = 360.0 / mask.hue_histogram.size
    hues = (np.arange(mask.hue_histogram.size) + 0.5) * width
    offset = (hues - mask.hue_mode + 180.0) % 360.0 - 180.0
    near = np.abs(offset) <= HUE_RANGE
    colors = hsv_to_rgb(np.stack([hues / 360, np.full_like(hues, 0.75), np.ones_like(hues)], 1))
    axes.bar(offset[near], 100.0 * mask.hue_histogram[near], width, color=colors[near])
    axes.axvspan(-half_width, half_width, color="0.92", zorder=0)
    for edge in (-half_width, half_width):
        axes.axvline(edge, color=BLACK, linewidth=1.0, linestyle=":")
    axes.set(xlim=(-HUE_RANGE, HUE_RANGE), ylabel="% of skin")
    axes.set_xlabel(f"hue, degrees from the most frequent one ({mask.hue_mode:.0f})")
