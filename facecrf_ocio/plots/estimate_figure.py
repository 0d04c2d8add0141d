"""An estimate alone as a figure, and as HTML for notebooks."""

from __future__ import annotations

import base64
from html import escape
from io import BytesIO

from matplotlib.figure import Figure

from facecrf_ocio.plots.calibration_plot import curves_only
from facecrf_ocio.values import Estimate
from facecrf_ocio.wording.sentence import PYTHON, sentence

_DOTS_PER_INCH = 72  # 430 points wide in a notebook, which is half of its column


def estimate_figure(estimate: Estimate) -> Figure:
    """Draw the curves with their bands, and the same in stops above sRGB.

    Raises
    ------
    NotCalibratedError
        If there is no curve.
    """
    return curves_only(estimate)


def estimate_html(estimate: Estimate) -> str:
    """Return what to expect of an estimate, and its picture if it has a curve."""
    told = estimate.confidence
    verdict = "" if told is None else f" ({told.verdict})"
    said = f"{estimate.outcome}{verdict}</b>: {escape(sentence(estimate, PYTHON))}"
    return f"<div><p><b>{said}</p>{_picture(estimate)}</div>"


def _picture(estimate: Estimate) -> str:
    if estimate.found is None:
        return ""
    content = BytesIO()
    curves_only(estimate).savefig(content, format="png", dpi=_DOTS_PER_INCH)
    text = base64.b64encode(content.getvalue()).decode()
    return f'<img alt="the curve and its 90 % band" src="data:image/png;base64,{text}">'
