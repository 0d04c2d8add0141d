"""What an estimate offers where Python is used by hand: what to expect, a picture, HTML."""

from __future__ import annotations

from importlib import import_module
from typing import Any


class Displayed:
    """Tells and draws itself; what does is imported by name when asked for, as it stands above."""

    __slots__ = ()

    @property
    def summary(self) -> str:
        """What to expect of the curve and what would make it surer, or why there is none."""
        words = import_module("facecrf_ocio.wording.sentence")
        return str(words.sentence(self, words.PYTHON))

    def plot(self) -> Any:
        """Draw the curves with their 90 % bands, and how they differ from sRGB in stops.

        Returns
        -------
        matplotlib.figure.Figure
            To be shown by a notebook, or saved by its `savefig`.

        Raises
        ------
        NotCalibratedError
            If there is no curve.
        """
        return _drawing().estimate_figure(self)

    def _repr_html_(self) -> str:
        """Return the estimate as Jupyter shows it: what to expect, and the picture."""
        return str(_drawing().estimate_html(self))


def _drawing() -> Any:
    return import_module("facecrf_ocio.plots.estimate_figure")
