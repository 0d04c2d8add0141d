"""The files that benches leave behind."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from facecrf_ocio.benchmark.laid_out import csv_table
from facecrf_ocio.benchmark.tables import (
    Row,
    results_csv,
    results_record,
    rows_csv,
    timing_markdown,
)
from facecrf_ocio.benchmark.workbench import CaseResult
from facecrf_ocio.files.atomic import Draft, write_files
from facecrf_ocio.files.strict_json import dump


def write_tables(
    output: Path,
    text: str,
    run: Mapping[str, object],
    rows: Sequence[Row],
    results: Sequence[CaseResult],
) -> tuple[Path, ...]:
    """Write `table.md`, `table.csv`, `cases.csv`, `results.json` and `timing.md`.

    All of them but the last are the same for the same run, however often it was interrupted.

    Parameters
    ----------
    output
        Folder; earlier tables in it are replaced.
    text
        The table for people.
    run
        Everything needed to repeat the run.
    rows, results
        Statistics, and every case.
    """
    contents = {
        "table.md": text.encode(),
        "table.csv": rows_csv(rows),
        "cases.csv": results_csv(results),
        "results.json": dump(results_record(run, rows, results)),
        "timing.md": timing_markdown(results).encode(),
    }
    return _written(output, contents)


def write_cases(
    output: Path, name: str, text: str, run: object, cases: Sequence[Mapping[str, object]]
) -> tuple[Path, ...]:
    """Write NAME.md, the table for people, NAME.csv, every case, and NAME.json, with the run."""
    contents = {"md": text.encode(), "csv": csv_table(cases)}
    contents["json"] = dump({"run": run, "cases": cases})
    return _written(output, {f"{name}.{kind}": content for kind, content in contents.items()})


def _written(output: Path, contents: Mapping[str, bytes]) -> tuple[Path, ...]:
    drafts = [Draft(output / name, content, lambda _: None) for name, content in contents.items()]
    return write_files(drafts, overwrite=True)
