"""From results to statistics, and on to the tables people read and the files programs read."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import TypeVar

import numpy as np

from facecrf_ocio.benchmark.cases import HELD_OUT, PAPER
from facecrf_ocio.benchmark.laid_out import csv_of, markdown_table, number
from facecrf_ocio.benchmark.workbench import CaseResult
from facecrf_ocio.values import Verdict

_Key = TypeVar("_Key", bound=Hashable)
_Photos = Mapping[tuple[str, str, int], float]
_TITLES = {
    HELD_OUT: "Held-out protocol: the prior never saw the tested curve nor its fold",
    PAPER: "Paper protocol: the shipped prior, which has seen all DoRF curves",
    "pairs": "Real cameras, responses fitted to linear images of the same exposures",
}
LEGEND = """\
In stops, with one free factor taken out at code 128: the mean of |log2(g / truth)| over codes 64 to
235 (median, mean and maximum over the photos), over the shadows 16 to 64, and over the codes that
the photo uses (their means). < sRGB: share of photos on which it is below that of sRGB decoding,
over codes 64 to 235. RMSE: of g x 100 on 1,024 uniform encoded values with g(1) = 1, mean of the
channels, as the paper has it. A photo that the estimator refused (or failed on) is scored as the
prior's mean curve; `answered` counts only the others. < mean: share of photos on which the RMSE is
below that of the mean curve. bands: share of codes with |error| < 1.645 sigma, in stops and in
linear light, 90 % if sigma is honest. reliable: share of photos whose estimate has that verdict,
and how many of these are right: within 0.15 stops over codes 64 to 235, and nearer than sRGB
decoding or within 0.05."""
# What `reliable` must mean to be right: the error in stops over codes 64 to 235, and that below
# which an estimate need not be nearer than sRGB decoding, which may be the truth.
RIGHT, RIGHT_NEAR_SRGB = 0.15, 0.05
_HEADINGS = (
    "estimator|stops median|mean|max|shadows|used|< sRGB %|band %|RMSE median|mean|max|std|"
    "< mean %|band %|refused %|failed %|answered median|answered mean|reliable %|these right %"
)


@dataclass(frozen=True, slots=True)
class Row:
    """Statistics of one estimator under one protocol.

    Attributes
    ----------
    cases
        Number of photos.
    mid_median, mid_mean, mid_max, shadows_mean, used_mean
        In stops, see `metrics.Score`.
    nearer_than_srgb
        Share of photos whose error in stops, over codes 64 to 235, is below that of sRGB decoding;
        None where that was not asked.
    rmse_min, rmse_median, rmse_mean, rmse_max, rmse_std
        Of `CaseResult.rmse` (not multiplied by 100); population standard deviation.
    better_than_mean
        Share of photos whose RMSE is below that of the mean curve under the same protocol.
    refused, failed
        Shares of photos without an answer, and of those where the estimator broke down.
    answered_median, answered_mean
        RMSE of the other photos alone; None if there are none.
    band_coverage, band_stops
        Mean share of codes within the 90 % bands, in linear light and in stops.
    reliable, reliable_right
        Share of photos with the verdict `reliable`, and share of these that `is_right`; None if
        there are none.
    """

    protocol: str
    estimator: str
    cases: int
    mid_median: float
    mid_mean: float
    mid_max: float
    shadows_mean: float
    used_mean: float | None
    nearer_than_srgb: float | None
    rmse_min: float
    rmse_median: float
    rmse_mean: float
    rmse_max: float
    rmse_std: float
    better_than_mean: float
    refused: float
    failed: float
    answered_median: float | None
    answered_mean: float | None
    band_coverage: float | None
    band_stops: float | None
    reliable: float
    reliable_right: float | None


def is_right(mid: float, srgb_mid: float) -> bool:
    """Whether errors in stops, of an estimate and of sRGB decoding, bear out `reliable`."""
    return mid <= RIGHT and (mid < srgb_mid or mid <= RIGHT_NEAR_SRGB)


def summarize(results: Sequence[CaseResult]) -> tuple[Row, ...]:
    """One row for each protocol and estimator, in the order of the results."""
    groups = grouped(results, lambda result: (result.protocol, result.estimator))
    blind = {(r.protocol, r.image, r.row): r.rmse for r in results if r.estimator == "mean"}
    srgb = {(r.protocol, r.image, r.row): r.mid for r in results if r.estimator == "srgb"}
    return tuple(_row(group, blind, srgb) for group in groups.values())


def grouped(
    results: Iterable[CaseResult], key: Callable[[CaseResult], _Key]
) -> dict[_Key, list[CaseResult]]:
    """Results by key, in the order in which keys first occur."""
    groups: dict[_Key, list[CaseResult]] = {}
    for result in results:
        groups.setdefault(key(result), []).append(result)
    return groups


def _row(group: Sequence[CaseResult], blind: _Photos, srgb: _Photos) -> Row:
    rmse = np.array([result.rmse for result in group])
    answered = np.array([result.rmse for result in group if result.answered])
    better = [r.rmse < blind.get((r.protocol, r.image, r.row), np.inf) for r in group]
    against = [(r, srgb[key]) for r in group if (key := (r.protocol, r.image, r.row)) in srgb]
    vouched = [r for r in group if r.verdict == Verdict.RELIABLE]
    borne_out = [is_right(r.mid, s) for r, s in against if r.verdict == Verdict.RELIABLE]
    broken = [result.outcome == "failed" for result in group]
    mid = np.array([result.mid for result in group])
    return Row(
        protocol=group[0].protocol,
        estimator=group[0].estimator,
        cases=len(group),
        mid_median=float(np.median(mid)),
        mid_mean=float(mid.mean()),
        mid_max=float(mid.max()),
        shadows_mean=float(np.mean([result.shadows for result in group])),
        used_mean=mean_of(result.used for result in group),
        nearer_than_srgb=mean_of(r.mid < s for r, s in against),
        rmse_min=float(rmse.min()),
        rmse_median=float(np.median(rmse)),
        rmse_mean=float(rmse.mean()),
        rmse_max=float(rmse.max()),
        rmse_std=float(rmse.std()),
        better_than_mean=float(np.mean(better)),
        refused=1.0 - len(answered) / len(group),
        failed=float(np.mean(broken)),
        answered_median=float(np.median(answered)) if answered.size else None,
        answered_mean=float(answered.mean()) if answered.size else None,
        band_coverage=mean_of(result.band_coverage for result in group),
        band_stops=mean_of(result.band_stops for result in group),
        reliable=len(vouched) / len(group),
        reliable_right=mean_of(borne_out),
    )


def mean_of(values: Iterable[float | None]) -> float | None:
    """Mean of those that are known; None if none is."""
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None


def markdown(rows: Sequence[Row]) -> str:
    """The tables, one for each protocol, and what their columns mean."""
    parts = []
    headings = _HEADINGS.split("|")
    for protocol in dict.fromkeys(row.protocol for row in rows):
        chosen = [row for row in rows if row.protocol == protocol]
        parts += [
            f"{_TITLES.get(protocol, protocol)} ({chosen[0].cases} photos)",
            markdown_table(headings, [_cells(row) for row in chosen]),
        ]
    return "\n\n".join([*parts, LEGEND]) + "\n"


def timing_markdown(results: Sequence[CaseResult]) -> str:
    """Seconds per photo, kept out of the tables because no two runs agree on them."""
    cells = []
    for name, group in grouped(results, lambda result: result.estimator).items():
        times = [result.seconds for result in group]
        cells.append([name, *(f"{of(times):.3f}" for of in (np.median, np.mean, np.max))])
    return markdown_table(["seconds per photo", "median", "mean", "max"], cells) + "\n"


def rows_csv(rows: Sequence[Row]) -> bytes:
    """The tables' statistics at full precision."""
    return csv_of([field.name for field in fields(Row)], (asdict(row) for row in rows))


def results_csv(results: Sequence[CaseResult]) -> bytes:
    """Every case at full precision, without its time."""
    names = [field.name for field in fields(CaseResult) if field.name != "seconds"]
    return csv_of(names, (asdict(result) for result in results))


def results_record(
    description: Mapping[str, object], rows: Sequence[Row], results: Sequence[CaseResult]
) -> dict[str, object]:
    """For JSON: what was run, the table, and every case without its time."""
    cases = [asdict(result) for result in results]
    for case in cases:
        del case["seconds"]
    return {"run": description, "table": [asdict(row) for row in rows], "cases": cases}


def _cells(row: Row) -> list[str]:
    stops = (row.mid_median, row.mid_mean, row.mid_max, row.shadows_mean, row.used_mean)
    hundredfold = (row.rmse_median, row.rmse_mean, row.rmse_max, row.rmse_std)
    return [
        row.estimator,
        *(number(value, 1, 3) for value in stops),
        "" if row.estimator == "srgb" else number(row.nearer_than_srgb, 100, 0),
        number(row.band_stops, 100, 0),
        *(number(value, 100) for value in hundredfold),
        "" if row.estimator == "mean" else number(row.better_than_mean, 100, 0),
        number(row.band_coverage, 100, 0),
        number(row.refused, 100, 1),
        number(row.failed, 100, 1),
        number(row.answered_median, 100),
        number(row.answered_mean, 100),
        number(row.reliable, 100, 0),
        number(row.reliable_right, 100, 0),
    ]
