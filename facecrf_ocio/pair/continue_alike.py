"""How curves of three channels go on to white, above the samples, so that grays keep no cast.

Pictures rarely show all channels up to white, and the row of each channel's gains is free: so how a
channel goes on decides its light beside the others'. Continued one by one, equal curves came out
0.2 to 0.9 stops apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from facecrf_ocio.pair.extrapolate import continued
from facecrf_ocio.pair.fit_channel import ChannelFit
from facecrf_ocio.pair.flat_pixels import Samples
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.values import Float

SEEN = (0.01, 0.99)
"""Quantiles of a channel's samples between which its curve is what they say."""


def continued_alike(
    fits: Sequence[ChannelFit], samples: Sequence[Samples], model: ResponseModel
) -> list[ChannelFit]:
    """The fits, each going on above its samples as the channel does that is seen highest.

    That one goes on as the nearest known response does. Values are continued, not slopes, which
    samples tell less well.
    """
    ranges = [np.quantile(one.encoded, SEEN) for one in samples]
    highest = int(np.argmax([top for _, top in ranges]))
    low, top = ranges[highest]
    seen = (model.grid >= low) & (model.grid <= top)
    grid = np.linspace(0.0, 1.0, fits[highest].linear.size)
    own = np.interp(model.grid, grid, fits[highest].linear)
    known = np.interp(grid, model.grid, continued(own, seen, model))
    guide = _going_on(fits[highest].linear, known, grid, top)
    return [
        _rescaled(fit, _going_on(fit.linear, guide, grid, float(upper)))
        for fit, (_, upper) in zip(fits, ranges, strict=True)
    ]


def _going_on(linear: Float, guide: Float, grid: Float, top: float) -> Float:
    """Linear light (K,) up to the code `top` as it is, above in proportion to the guide (K,)."""
    at_top = np.interp(top, grid, linear) / np.interp(top, grid, guide)
    return np.where(grid <= top, linear, at_top * guide)


def _rescaled(fit: ChannelFit, linear: Float) -> ChannelFit:
    """The fit with another curve above, white being 1 again."""
    white = linear[-1]
    return replace(
        fit, linear=linear / white, mixing=fit.mixing / white, residual=fit.residual / white
    )
