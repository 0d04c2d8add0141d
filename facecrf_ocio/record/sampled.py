"""How a record holds numbers along a curve: once for channels that are alike, and thinned.

A row of numbers is a list; or `{"at": [...], "is": [...]}`, numbers at these indices of the row,
linear between them. Codes that are uniform from 0 to 1 are `{"uniform": count}`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import CHANNELS, Float

TOLERANCE = 1e-5
"""By how much numbers read back may differ from a smooth row that was thinned."""

_MOST = 1 << 20  # numbers of a curve: sixteen for each code value of 16 bits
_DECIMALS = 7  # of a stored value; half of the last is far below what `TOLERANCE` allows
_STRAIGHT = 1e-13  # what float64 makes of a line's second differences is less, what bends is more


def codes_record(codes: Float) -> Float | dict[str, int]:
    """Encoded values (K,) as they are written."""
    uniform = codes.size > 1 and np.array_equal(codes, np.linspace(0.0, 1.0, codes.size))
    return {"uniform": codes.size} if uniform else codes


def read_codes(record: Any) -> Float:
    """(K,) encoded values that `codes_record` wrote."""
    if isinstance(record, dict):
        return np.linspace(0.0, 1.0, _count(record["uniform"]))
    return np.array(record, np.float64)


def _count(number: Any) -> int:
    if not 2 <= int(number) <= _MOST:
        raise ValueError(f"a curve has 2 to {_MOST} numbers")
    return int(number)


def one_for_all(rows: Float) -> Float:
    """The first of (C, K) rows if all are alike, as (1, K)."""
    return rows[:1] if np.array_equal(rows, np.broadcast_to(rows[0], rows.shape)) else rows


def thinned(rows: Float) -> list[object]:
    """Rows (C, K) as they are written: smooth ones within `TOLERANCE`, others to six digits.

    What was read back is written the same again. Rows that hold a number that is not finite are
    written in full.
    """
    return [_row_record(row) for row in one_for_all(np.asarray(rows, np.float64))]


def _row_record(row: Float) -> object:
    knots = _few_knots(row)
    if knots is None:
        row = np.array([float(f"{number:.6g}") for number in row.tolist()])
        knots = _few_knots(row)  # as whoever reads and writes it again would see it
    if knots is None:
        return row.tolist()
    back = np.interp(np.arange(row.size), knots, row[knots].round(_DECIMALS))
    knots = _bends(back)  # without those that rounding made superfluous
    return {"at": knots.tolist(), "is": back[knots].round(_DECIMALS).tolist()}


def read_rows(record: list[Any]) -> Float:
    """(3, K) numbers of which fewer may be written; null is NaN."""
    rows = np.stack([_read_row(row) for row in record])
    return np.repeat(rows, len(CHANNELS), axis=0) if len(rows) == 1 else rows


def _read_row(row: Any) -> Float:
    if not isinstance(row, dict):
        return np.array(row, np.float64)
    at, values = np.array(row["at"], np.intp), np.array(row["is"], np.float64)
    if at.size == 0 or at[0] != 0 or (np.diff(at) <= 0).any():
        raise ValueError("its numbers are not in order")
    return np.interp(np.arange(_count(at[-1] + 1)), at, values)


def _few_knots(row: Float) -> npt.NDArray[np.intp] | None:
    """Indices between which (K,) is linear enough, None if that takes more than K / 4.

    None as well where a number is not finite.
    """
    if not np.isfinite(row).all():
        return None
    knots = _bends(row)
    return knots if 4 * knots.size < row.size else _knots(row)


def _bends(row: Float) -> npt.NDArray[np.intp]:
    """Indices of the ends of (K,), and of those between where it is not linear at all."""
    bends = np.ones(row.size, bool)
    slopes = row[1:] - row[:-1]
    bends[1:-1] = np.abs(slopes[1:] - slopes[:-1]) > _STRAIGHT
    return np.flatnonzero(bends)


def _knots(row: Float) -> npt.NDArray[np.intp] | None:
    """Indices between which (K,) is linear within `TOLERANCE`; None of K / 4 and more.

    Every gap gets the index where a line across it errs most, until none errs too much (Douglas and
    Peucker 1973, all gaps at a time).
    """
    places, limit = np.arange(row.size), 0.9 * TOLERANCE  # the rest is for rounding
    knots = places[:: max(1, row.size - 1)]
    while 4 * knots.size < row.size:
        error = np.abs(np.interp(places, knots, row[knots]) - row)
        worst = np.maximum.reduceat(error, knots)
        far = np.flatnonzero(worst > limit)
        if far.size == 0:
            return knots
        gaps = zip(knots[far].tolist(), knots[far + 1].tolist(), strict=True)
        between = [first + int(error[first:end].argmax()) for first, end in gaps]
        knots = np.sort(np.concatenate([knots, between]))
    return None
