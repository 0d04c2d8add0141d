"""Errors by percentile and by group: what a mean over all photos hides."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.tables import markdown_table
from facecrf_ocio.benchmark.workbench import Result
from facecrf_ocio.errors import PhotoError, reason_of
from facecrf_ocio.response.fixed import FIXED_CURVES

PERCENTILES = (5, 10, 25, 50, 75, 90, 95, 99)
_LEFT_OUT = frozenset(FIXED_CURVES) - {"mean", "srgb"}


def percentiles_markdown(results: Sequence[Result]) -> str:
    """Percentiles of RMSE x 100 for each protocol and estimator."""
    cells = []
    for (protocol, estimator), group in _by(results, lambda r: (r.protocol, r.estimator)).items():
        values = 100.0 * np.percentile([result.rmse for result in group], PERCENTILES)
        cells.append([estimator, protocol, *(f"{value:.2f}" for value in values)])
    headings = ["percentiles of RMSE x 100", "protocol", *map(str, PERCENTILES)]
    return markdown_table(headings, cells) + "\n"


def groups_markdown(
    results: Sequence[Result], title: str, group_of: Callable[[Result], str]
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
    named = [result for result in results if group_of(result)]
    cells = []
    for (protocol, name), group in sorted(
        _by(named, lambda r: (r.protocol, group_of(r))).items(), key=lambda item: item[0]
    ):
        for estimator, own in _by(group, lambda r: (r.estimator, "")).items():
            if estimator[0] not in _LEFT_OUT:
                cells.append([name, protocol, estimator[0], *_numbers(own)])
    if not cells:
        return ""
    headings = [title, "protocol", "estimator", "photos", "median", "mean", "max"]
    return markdown_table([*headings, "scaled median", "band %"], cells) + "\n"


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


def _numbers(group: Sequence[Result]) -> list[str]:
    rmse = 100.0 * np.array([result.rmse for result in group])
    scaled = 100.0 * np.median([result.rmse_scaled for result in group])
    bands = [result.band_coverage for result in group if result.band_coverage is not None]
    band = f"{100.0 * np.mean(bands):.0f}" if bands else "-"
    numbers = [f"{value:.2f}" for value in (np.median(rmse), rmse.mean(), rmse.max(), scaled)]
    return [str(len(group)), *numbers, band]


def _by(
    results: Sequence[Result], key: Callable[[Result], tuple[str, str]]
) -> Mapping[tuple[str, str], list[Result]]:
    """Results by key, in the order in which keys first occur."""
    groups: dict[tuple[str, str], list[Result]] = {}
    for result in results:
        groups.setdefault(key(result), []).append(result)
    return groups
