"""Errors by percentile and by group: what a mean over all photos hides."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.laid_out import markdown_table, number
from facecrf_ocio.benchmark.tables import Row, grouped, summarize
from facecrf_ocio.benchmark.workbench import CaseResult
from facecrf_ocio.errors import PhotoError, reason_of
from facecrf_ocio.estimators import FIXED_CURVES

# The middle half by quarters, and the tails, which a mean hides.
PERCENTILES = (5, 10, 25, 50, 75, 90, 95, 99)
_LEFT_OUT = frozenset(FIXED_CURVES) - {"mean", "srgb"}


def percentiles_markdown(results: Sequence[CaseResult]) -> str:
    """Percentiles of the error in stops and of RMSE x 100 for each protocol and estimator."""
    groups = grouped(results, lambda result: (result.protocol, result.estimator))
    stops, hundredfold = [], []
    for (protocol, estimator), group in groups.items():
        mid = np.percentile([result.mid for result in group], PERCENTILES)
        rmse = 100.0 * np.percentile([result.rmse for result in group], PERCENTILES)
        stops.append([estimator, protocol, *(f"{value:.3f}" for value in mid)])
        hundredfold.append([estimator, protocol, *(f"{value:.2f}" for value in rmse)])
    headings = ["protocol", *map(str, PERCENTILES)]
    return "\n\n".join(
        [
            markdown_table(["percentiles of stops, 64-235", *headings], stops),
            markdown_table(["percentiles of RMSE x 100", *headings], hundredfold) + "\n",
        ]
    )


def groups_markdown(
    results: Sequence[CaseResult], title: str, group_of: Callable[[CaseResult], str]
) -> str:
    """Errors of each group beside those of the mean curve and of sRGB decoding.

    Parameters
    ----------
    results
        Of one bench.
    title
        What the groups are groups of.
    group_of
        Name of a result's group; empty leaves it out.

    Returns
    -------
    str
        A Markdown table, empty if no result has a group.
    """
    groups = grouped(results, lambda result: (result.protocol, group_of(result)))
    cells = [
        [name, protocol, row.estimator, *_numbers(row)]
        for (protocol, name), group in sorted(groups.items(), key=lambda item: item[0])
        for row in summarize(group)
        if name and row.estimator not in _LEFT_OUT
    ]
    if not cells:
        return ""
    headings = [title, "protocol", "estimator", "photos", "stops median", "mean", "max", "shadows"]
    others = ["band %", "RMSE median", "mean", "max", "band %"]
    return markdown_table([*headings, *others], cells) + "\n"


def image_groups(path: Path, column: str) -> dict[str, str]:
    """Groups of images by a column of a tab-separated table, whatever column has their names.

    Returns
    -------
    dict
        From each file name that stands in any cell of a row to the row's group.

    Raises
    ------
    PhotoError
        If the table cannot be read or has no such column.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise PhotoError(path, reason_of(error), "name a file that can be read") from error
    except UnicodeDecodeError as error:
        raise PhotoError(path, "is not UTF-8 text", "give a tab-separated table") from error
    rows = list(csv.DictReader(lines, delimiter="\t"))
    if not rows or column not in rows[0]:
        known = ", ".join(rows[0]) if rows else "none"
        raise PhotoError(path, f"has no column {column}", f"name one of its columns: {known}")
    return {
        Path(cell).name: row[column]
        for row in rows
        for name, cell in row.items()
        if isinstance(cell, str) and name != column and Path(cell).suffix
    }


def _numbers(row: Row) -> list[str]:
    stops = (row.mid_median, row.mid_mean, row.mid_max, row.shadows_mean)
    hundredfold = (row.rmse_median, row.rmse_mean, row.rmse_max)
    return [
        str(row.cases),
        *(number(error, 1, 3) for error in stops),
        number(row.band_stops, 100, 0),
        *(number(error, 100) for error in hundredfold),
        number(row.band_coverage, 100, 0),
    ]
