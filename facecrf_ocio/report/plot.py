"""One picture of a calibration: its curves, and the face it rests on (the paper's Fig. 4b)."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from facecrf_ocio.cues.face import AnalyzedFace, analyze_face, cut_face
from facecrf_ocio.export.atomic import Draft, write_files
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import CHANNELS, Estimate, Photo

INK = {"R": "#c8322b", "G": "#2f8f46", "B": "#2b5fc8"}
MELANIN_COLOR = (1.0, 0.85, 0.0)
HEMOGLOBIN_COLOR = (0.9, 0.0, 0.1)
DIMMED = 0.35


def write_plot(
    path: Path, photo: Photo, estimate: Estimate, settings: Settings, *, overwrite: bool = False
) -> Path:
    """Write the curves with their bands, sRGB for comparison, and the first face, as PNG.

    Raises
    ------
    OutputError
        If the file exists and `overwrite` is false, or it cannot be written.
    """
    analyzed = None
    if estimate.faces:
        analyzed = analyze_face(cut_face(photo, estimate.faces[0], settings), settings)
    figure = Figure(figsize=(13.0, 5.2) if analyzed else (6.0, 5.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, 3 if analyzed else 1, squeeze=False)[0]
    _draw_curves(axes[0], estimate)
    if analyzed:
        axes[1].imshow(analyzed.view.encoded)
        axes[1].set_title("face, encoded")
        axes[2].imshow(pigment_map(analyzed))
        axes[2].set_title("melanin-only (yellow), hemoglobin-only (red)", fontsize=10)
        for axis in axes[1:]:
            axis.set_axis_off()
    name = "photo" if photo.path is None else photo.path.name
    verdict = "" if estimate.confidence is None else f", {estimate.confidence.verdict}"
    figure.suptitle(
        f"{name}: {estimate.outcome} by {estimate.estimator}{verdict}", parse_math=False
    )
    content = BytesIO()
    figure.savefig(content, format="png", dpi=120)
    return write_files([Draft(path, content.getvalue(), lambda _: None)], overwrite=overwrite)[0]


def pigment_map(analyzed: AnalyzedFace) -> npt.NDArray[np.float32]:
    """The face dimmed outside of the diffuse skin, pairs marked in their pigment's color.

    Returns
    -------
    numpy.ndarray
        (H, W, 3) float32 in [0, 1].
    """
    picture = analyzed.view.encoded * np.where(analyzed.mask.diffuse, 1.0, DIMMED)[..., None]
    rows, columns = np.nonzero(analyzed.mask.skin)
    for chosen, color in (
        (analyzed.gradients.is_melanin, MELANIN_COLOR),
        (~analyzed.gradients.is_melanin, HEMOGLOBIN_COLOR),
    ):
        pixels = analyzed.gradients.pairs[chosen].ravel()
        picture[rows[pixels], columns[pixels]] = color
    return np.asarray(picture, dtype=np.float32)


def _draw_curves(axes: Axes, estimate: Estimate) -> None:
    curve = estimate.curve
    srgb = fixed_curve("srgb", curve.encoded, dorf_model())
    axes.plot(curve.encoded, srgb, color="0.5", linestyle="--", linewidth=1.0, label="sRGB")
    for index, channel in enumerate(CHANNELS):
        linear = curve.linear[index]
        axes.plot(curve.encoded, linear, color=INK[channel], linewidth=1.6, label=channel)
        if estimate.confidence is not None:
            sigma = estimate.confidence.sigma[index]
            low, high = np.clip([linear - sigma, linear + sigma], 0.0, 1.0)
            axes.fill_between(curve.encoded, low, high, color=INK[channel], alpha=0.10, linewidth=0)
    axes.set(
        xlabel="encoded value",
        ylabel="relative linear light",
        xlim=(0, 1),
        ylim=(0, 1),
        aspect="equal",
    )
    axes.set_title("inverse camera response")
    axes.grid(color="0.9")
    axes.legend(loc="upper left", frameon=False)
