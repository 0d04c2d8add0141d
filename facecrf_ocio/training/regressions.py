"""Logistic regressions: of two classes, and of which of some candidates is the true one."""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit, logsumexp

from facecrf_ocio.values import Float


def two_classes(no: Float, yes: Float, ridge: float, *, balanced: bool) -> tuple[Float, float]:
    """Weights (D,) and constant of the log odds that a row is of the second class.

    Parameters
    ----------
    no, yes
        (N, D) and (M, D) rows of each class.
    ridge
        Penalty of squared weights, of columns scaled to a deviation of 1.
    balanced
        Whether both classes count the same, however many rows they have.
    """
    rows = np.vstack([no, yes])
    center, scale = rows.mean(axis=0), _scale(rows)
    scaled = (rows - center) / scale
    truth = np.repeat([0.0, 1.0], [len(no), len(yes)])
    share = np.repeat([len(rows) / 2 / len(no), len(rows) / 2 / len(yes)], [len(no), len(yes)])
    counts = share if balanced else np.ones(len(rows))

    def loss(found: Float) -> tuple[float, Float]:
        odds = scaled @ found[1:] + found[0]
        off = (expit(odds) - truth) * counts
        cost = counts @ (np.logaddexp(0.0, odds) - truth * odds)
        slope = np.concatenate([[off.sum()], scaled.T @ off + ridge * found[1:]])
        return float(cost + ridge * (found[1:] @ found[1:]) / 2.0), slope

    found = minimize(loss, np.zeros(1 + rows.shape[1]), jac=True, method="L-BFGS-B").x
    weights = found[1:] / scale
    return weights, float(found[0] - weights @ center)


def first_of(candidates: Float, ridge: float) -> Float:
    """Weights (D,) by which the first of K candidates is likeliest, of (N, K, D) rows."""
    scale = _scale(candidates.reshape(-1, candidates.shape[-1]))
    scaled = candidates / scale

    def loss(weights: Float) -> tuple[float, Float]:
        odds = scaled @ weights
        whole = logsumexp(odds, axis=1)
        likely = np.exp(odds - whole[:, None])
        mean = np.einsum("nk,nkd->nd", likely, scaled)
        slope = (mean - scaled[:, 0]).sum(axis=0) + ridge * weights
        return float((whole - odds[:, 0]).sum() + ridge * (weights @ weights) / 2.0), slope

    found = minimize(loss, np.zeros(candidates.shape[-1]), jac=True, method="L-BFGS-B").x
    return np.asarray(found / scale)


def _scale(rows: Float) -> Float:
    """(D,) deviations; 1 where all are alike, which tells nothing."""
    deviation = rows.std(axis=0)
    return np.where(deviation > 0.0, deviation, 1.0)
