"""What the tables of peers have in common: a missing package, errors of a curve, Markdown."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from facecrf_ocio.errors import FaceCRFError
from facecrf_ocio.response.model import dorf_model, inverse_crf
from facecrf_ocio.response.stops import stops_error, uniform
from facecrf_ocio.values import CHANNELS, Float, InverseCRF

EXTRA = "pip install 'facecrf-ocio[peers]'"


class MissingPeerError(FaceCRFError):
    """Software that is not installed; the message is a line for the user."""


def peer(module: str, name: str) -> Any:
    """Import a peer's package.

    Raises
    ------
    MissingPeerError
        If it is not installed.
    """
    try:
        return import_module(module)
    except ImportError:
        raise MissingPeerError(f"{name} is not installed: {EXTRA}") from None


@dataclass(frozen=True, slots=True)
class CurveErrors:
    """How far curves lie from the truth, over all cases; NaN where none was answered.

    Attributes
    ----------
    mid, median, worst, shadows
        [stop] Mean over the cases of the error over codes 64 to 235, their median, the largest of
        them, and the mean over codes 16 to 64.
    rmse
        Root mean square error with white at 1, in the mean.
    answered
        Share of the cases that were answered; the others count in none of the errors.
    """

    mid: float
    median: float
    worst: float
    shadows: float
    rmse: float
    answered: float


Answer = Callable[[int], InverseCRF | None]
"""The curve for a case, None where it is refused."""


def curve_errors(answer: Answer, truths: Sequence[InverseCRF]) -> CurveErrors:
    """Errors of an answer to every case."""
    rows = []
    for case, truth in enumerate(truths):
        found = answer(case)
        if found is not None:
            rows.append(_errors(found, truth))
    share = len(rows) / len(truths)
    if not rows:
        return CurveErrors(*(float("nan"),) * 5, share)
    mid, shadows, rmse = np.transpose(rows)
    middle, largest = float(np.median(mid)), float(mid.max())
    rest = float(shadows.mean()), float(rmse.mean()), share
    return CurveErrors(float(mid.mean()), middle, largest, *rest)


def _errors(found: InverseCRF, truth: InverseCRF) -> tuple[float, float, float]:
    ours, theirs = uniform(found), uniform(truth)
    stops = stops_error(ours, theirs, np.ones((len(CHANNELS), 256), np.int64))
    return stops.mid, stops.shadows, float(np.sqrt(((ours - theirs) ** 2).mean()))


def as_curve(codes: Float, light: Float) -> InverseCRF:
    """(3, K) light at K codes in [0, 1] as a curve from 0 to 1; what falls is lifted."""
    rows = np.maximum.accumulate(np.nan_to_num(light, posinf=0.0), axis=1)
    rows = rows - rows[:, :1]
    return inverse_crf(codes, rows / np.maximum(rows[:, -1:], 1e-12))


def trivial(curve: Callable[[Float], Float]) -> Answer:
    """The answer of a curve that looks at nothing."""
    grid = dorf_model().grid
    made = inverse_crf(grid, np.array([curve(grid)] * len(CHANNELS)))
    return lambda _: made


def curve_rows(
    answers: Mapping[str, Answer], truths: Sequence[InverseCRF], missing: Callable[[str], None]
) -> Iterator[str]:
    """Markdown, a line at a time; peers that are missing are told and left out."""
    yield "| curve by | stops 64-235: median | mean | largest | 16-64 | RMSE x 100 | answered |"
    yield "|---|---|---|---|---|---|---|"
    for name, answer in answers.items():
        try:
            found = curve_errors(answer, truths)
        except MissingPeerError as error:
            missing(str(error))
            continue
        stops = (found.median, found.mid, found.worst, found.shadows)
        numbers = " | ".join(f"{value:.3f}" for value in stops)
        yield f"| {name} | {numbers} | {100 * found.rmse:.1f} | {100 * found.answered:.0f} % |"


def markdown(head: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """A table in Markdown, a line at a time."""
    yield f"| {' | '.join(head)} |"
    yield "|" + "---|" * len(head)
    for row in rows:
        yield f"| {' | '.join(row)} |"
