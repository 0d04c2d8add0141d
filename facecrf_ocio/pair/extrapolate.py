"""Continue a curve that is known over a part of the codes, as known responses go on."""

from __future__ import annotations

import numpy as np

from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.values import Bool, Float

_TOLERANCE = 0.002  # [linear] by which the seen part may miss its candidate
_MIN_SLOPE = 1e-4  # [linear per encoded] so that the curve increases


def continued(curve: Float, seen: Bool, model: ResponseModel) -> Float:
    """The known kind of curve that is nearest to `curve` where it is seen, up to its scale.

    The scale of a response is that of its highest code, which no unclipped pixel has; so how a
    curve goes on decides the scale of all of it. Candidates are sRGB and the mean response, each
    plus the eigenvectors of the response model as far as the prior finds them likely.

    Parameters
    ----------
    curve
        (K,) on the model's grid, at any scale.
    seen
        (K,) where it is known.
    model
        Mean, eigenvectors and their spread.

    Returns
    -------
    numpy.ndarray
        (K,) increasing from 0 to 1.
    """
    candidates = [
        _nearest(curve, seen, fixed_curve(name, model.grid, model), model)
        for name in ("mean", "srgb")
    ]
    best = min(candidates, key=lambda candidate: candidate[0])[1]
    slopes = np.maximum(np.diff(best), _MIN_SLOPE / best.size)
    rising = np.concatenate([[0.0], np.cumsum(slopes)])
    return np.asarray(rising / rising[-1])


def _nearest(curve: Float, seen: Bool, base: Float, model: ResponseModel) -> tuple[float, Float]:
    """Minimize |s curve - base - c H|^2 where seen, plus |c|^2 in units of its spread.

    Returns the misfit and `base + c H`; `curve`, `seen` and `base` are (K,).
    """
    spread = np.sqrt(np.diagonal(model.mixture.covariances, axis1=1, axis2=2).mean(axis=0))
    weight = 1 / (_TOLERANCE * np.sqrt(seen.sum()))
    rows = weight * np.column_stack([curve[seen], -(model.basis * spread[:, None])[:, seen].T])
    ridge = np.hstack([np.zeros((spread.size, 1)), np.eye(spread.size)])
    system = np.vstack([rows, ridge])
    right = np.concatenate([weight * base[seen], np.zeros(spread.size)])
    solution, *_ = np.linalg.lstsq(system, right, rcond=None)
    misfit = float(((system @ solution - right) ** 2).sum())
    return misfit, base + (solution[1:] * spread) @ model.basis
