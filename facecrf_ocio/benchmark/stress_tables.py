"""The tables of `facecrf bench stress`: a row for each cell, in stops and then as RMSE."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.laid_out import markdown_table, number
from facecrf_ocio.benchmark.tables import grouped, is_right, mean_of
from facecrf_ocio.benchmark.workbench import CaseResult
from facecrf_ocio.benchmark.written import write_cases
from facecrf_ocio.values import Float, Verdict

LEGEND = """\
In stops, with one free factor taken out at code 128: |log2(g / truth)|, its mean over codes 64 to
235 (median, mean, 95th percentile and largest over the photos), over the shadows 16 to 64, and over
the codes that each photo uses; expected: the mean of what the estimates say of their own error;
bias: mean of log2(g / truth) over 64 to 235. RMSE: of g x 100 on
1,024 uniform encoded values with g(1) = 1. band: share of codes within the 90 % band. < sRGB: share
of photos nearer to the truth than sRGB decoding, over codes 64 to 235. reliable: share of photos
with that verdict; right: how many of these are within 0.15 stops over codes 64 to 235, and nearer
than sRGB decoding or within 0.05. A refused photo is scored as the mean curve. Responses are held
out by fold and maker. day: what a day's photos go through, drawn at random."""
_STOPS = ("photos|median|mean|expected|95 %|max|bias|band %|shadows|expected|95 %|used|< sRGB %|"
          "reliable %|right %|refused %")  # fmt: skip
_RMSE = "photos|median|mean|95 %|max|bias|band %"
_BLIND = {"mean": "mean curve", "srgb": "sRGB decoding"}


def stress_markdown(title: str, results: Sequence[CaseResult]) -> str:
    """Both tables, and what their columns mean."""
    cells = list(dict.fromkeys(result.protocol for result in results))
    ours = grouped((r for r in results if r.estimator == "auto"), lambda r: r.protocol)
    srgb = {_photo(r): r.mid for r in results if r.estimator == "srgb"}
    blind = [cell for cell in cells if cell == "day"] + [c for c in cells if c != "day"][:1]
    groups: list[tuple[str, list[CaseResult]]] = list(ours.items())
    for name, label in _BLIND.items():
        of_name = grouped((r for r in results if r.estimator == name), lambda r: r.protocol)
        groups += [(f"{label}, {cell}", of_name[cell]) for cell in blind]
    stops = [[name, *_in_stops(group, srgb)] for name, group in groups]
    errors = [[name, *_as_rmse(group)] for name, group in groups]
    return "\n\n".join(
        [
            title,
            markdown_table(["stops", *_STOPS.split("|")], stops),
            markdown_table(["RMSE x 100", *_RMSE.split("|")], errors),
            LEGEND,
        ]
    )


def stress_files(
    title: str, description: Mapping[str, object], results: Sequence[CaseResult], output: Path
) -> tuple[str, tuple[Path, ...]]:
    """Write `stress.md`, `stress.csv` and `stress.json`; returns the table and the files."""
    text = stress_markdown(title, results) + "\n"
    cases = [asdict(result) for result in results]
    for case in cases:
        del case["seconds"]
    return text, write_cases(output, "stress", text, description, cases)


def _photo(result: CaseResult) -> tuple[str, str, int, str]:
    return result.protocol, result.image, result.row, result.response


def _in_stops(
    group: Sequence[CaseResult], srgb: Mapping[tuple[str, str, int, str], float]
) -> list[str]:
    mid, shadows = (np.array([getattr(r, name) for r in group]) for name in ("mid", "shadows"))
    vouched = [r for r in group if r.verdict == Verdict.RELIABLE]
    right = mean_of(is_right(r.mid, srgb[_photo(r)]) for r in vouched)
    judged = group[0].estimator == "auto"
    median, mean, high, largest = _spread(mid)
    return [
        str(len(group)),
        f"{median:.3f}",
        f"{mean:.3f}",
        number(mean_of(r.expected_mid for r in group), 1, 3),
        f"{high:.3f}",
        f"{largest:.3f}",
        f"{np.mean([r.bias_stops for r in group]):+.3f}",
        number(mean_of(r.band_stops for r in group), 100, 0),
        f"{shadows.mean():.3f}",
        number(mean_of(r.expected_shadows for r in group), 1, 3),
        f"{np.percentile(shadows, 95):.3f}",
        number(mean_of(r.used for r in group), 1, 3),
        number(mean_of(r.mid < srgb[_photo(r)] for r in group) if judged else None, 100, 0),
        number(len(vouched) / len(group) if judged else None, 100, 0),
        number(right, 100, 0),
        number(mean_of(not r.answered for r in group) if judged else None, 100, 0),
    ]


def _as_rmse(group: Sequence[CaseResult]) -> list[str]:
    return [
        str(len(group)),
        *(f"{value:.1f}" for value in _spread(100.0 * np.array([r.rmse for r in group]))),
        f"{100.0 * np.mean([r.bias for r in group]):+.1f}",
        number(mean_of(r.band_coverage for r in group), 100, 0),
    ]


def _spread(errors: Float) -> tuple[float, float, float, float]:
    median, high = np.percentile(errors, [50, 95])
    return float(median), float(errors.mean()), float(high), float(errors.max())
