"""What an estimate offers to a notebook: a picture, and itself as HTML."""

from __future__ import annotations

from importlib import import_module
from typing import Any


class Displayed:
    """Draws itself; what draws is imported by name when it is asked for, as it stands far above."""

    __slots__ = ()

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
