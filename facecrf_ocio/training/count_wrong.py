"""How often weights tell portraits that were made wrong, and doubt ordinary ones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from facecrf_ocio.benchmark.laid_out import markdown_table
from facecrf_ocio.joint.face_parts import ORDERS, SWAPPED, FaceColors
from facecrf_ocio.training.made_wrong import LEVELS, LIGHTS
from facecrf_ocio.training.wrong_pictures import PartWeights, ToldByFace, in_orders
from facecrf_ocio.values import Float

Counts = dict[str, tuple[int, int]]
"""By what was made: how many were told, of how many."""


def table(portraits: Sequence[ToldByFace], of: Sequence[PartWeights], seed: int) -> str:
    """What is told by each of some weights."""
    counts = [count(portraits, weights, seed) for weights in of]
    lines = [
        [name, str(made), *(str(one[name][0]) for one in counts)]
        for name, (_, made) in counts[0].items()
    ]
    return markdown_table(["", "made", *(f"told {n}" for n in range(1, 1 + len(of)))], lines)


def count(portraits: Sequence[ToldByFace], weights: PartWeights, seed: int) -> Counts:
    """What is told by weights, each rule by itself."""
    upright = np.array([one.upright for one in portraits])
    wrong = np.vstack([one.inverted for one in portraits])
    counts = {
        "not inverted": _above(upright @ weights.bright, weights.inverted),
        "inverted": _above(wrong @ weights.bright, weights.inverted),
        **_of_orders([o.colors for o in portraits if o.colors is not None], weights, seed),
    }
    rows: dict[str, list[Float]] = {}
    for one in portraits:
        for kind, told in one.ordinary:
            rows.setdefault(f"photos {kind}", []).append(told)
    for levels in LEVELS:
        made = [told for one in portraits for n, told in one.posters if n == levels]
        rows[f"posters of {levels} levels"] = made
    limit = weights.most_grainy
    return {
        **counts,
        **{k: _above(np.reshape(v, (-1, 3)) @ weights.grainy, limit) for k, v in rows.items()},
    }


def _of_orders(faces: Sequence[FaceColors], weights: PartWeights, seed: int) -> Counts:
    generator = np.random.default_rng(seed)
    counts: Counts = {}
    for name, light in LIGHTS.items():
        scores = np.array([in_orders(light.on(one, generator)) for one in faces]) @ weights.colored
        counts[f"{name}, not swapped"] = _above(_better(scores), SWAPPED)
        for order, what in enumerate(ORDERS.values(), start=1):
            # The order that was made is the given one, and the true one among the others.
            given = np.roll(scores, -order, axis=1)
            told, made = counts.get(f"{name}, {what}", (0, 0))
            more, of = _above(_better(given), SWAPPED)
            counts[f"{name}, {what}"] = (told + more, made + of)
    return counts


def _better(scores: Float) -> Float:
    """By how much the best other order fits better than the given one, the first."""
    return np.asarray(scores[:, 1:].max(axis=1) - scores[:, 0])


def _above(values: Float, limit: float) -> tuple[int, int]:
    return int(np.count_nonzero(values > limit)), int(values.size)
