"""Which curves the prior may see when one of them is tested."""

from __future__ import annotations

from collections import Counter

import numpy as np

from facecrf_ocio.benchmark.responses import Responses
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.response.fit_model import fit_model
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.values import Index

# DoRF lists red, green and blue of one film in adjacent rows without naming them: so many rows on
# either side of a block are kept from the prior too, or siblings of its outermost rows are seen.
GUARD_ROWS = 2
# A mixture of five Gaussians over five coefficients cannot be fitted to fewer.
MIN_TRAINING_CURVES = 20


def assign_folds(responses: Responses, folds: int) -> Index:
    """Fold of each response, (C,): whole makers where they are known, else contiguous blocks.

    Makers go to the emptiest fold, the largest first; there are no more folds than makers.

    Raises
    ------
    SettingsError
        If there are fewer than two folds, or not enough curves or makers for two.
    """
    count = len(responses.inverse)
    groups = count if responses.families is None else len(set(responses.families))
    if folds < 2 or groups < 2:
        kind = "curves" if responses.families is None else "makers"
        raise SettingsError(
            f"cannot hold out {folds} folds of {groups} {kind}; give at least two of both, or "
            "--protocol paper"
        )
    if responses.families is None:
        return np.asarray(np.arange(count) * min(folds, count) // count, dtype=np.intp)
    load = np.zeros(min(folds, groups), dtype=np.intp)
    fold_of_family = {}
    for family, size in Counter(responses.families).most_common():
        fold_of_family[family] = int(np.argmin(load))
        load[fold_of_family[family]] += size
    return np.array([fold_of_family[family] for family in responses.families], dtype=np.intp)


def training_rows(responses: Responses, fold_of: Index, fold: int) -> Index:
    """Rows that the prior of one of folds (N,) may see: all others, less the guard of a block."""
    seen = fold_of != fold
    if responses.families is None:
        block = np.flatnonzero(~seen)
        seen[max(0, block[0] - GUARD_ROWS) : block[-1] + 1 + GUARD_ROWS] = False
    return np.flatnonzero(seen)


def fit_held_out(responses: Responses, fold_of: Index, fold: int) -> ResponseModel:
    """Response model that never saw the curves of a fold.

    Raises
    ------
    SettingsError
        If the other folds hold too few curves.
    """
    curves = responses.training_curves(training_rows(responses, fold_of, fold))
    if len(curves) < MIN_TRAINING_CURVES:
        raise SettingsError(
            f"{responses.path}: {len(curves)} curves are left to fit the prior to when fold {fold} "
            f"is held out, {MIN_TRAINING_CURVES} are needed; use more folds, more curves, or "
            "--protocol paper"
        )
    return fit_model(curves)
