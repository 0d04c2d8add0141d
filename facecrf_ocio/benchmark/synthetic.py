"""Table 1: linear images through known responses, and how well each response is recovered."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.benchmark.cases import Plan
from facecrf_ocio.benchmark.folds import fit_held_out
from facecrf_ocio.benchmark.pool import measure_tasks
from facecrf_ocio.benchmark.store import Store
from facecrf_ocio.benchmark.tables import Row, markdown, summarize, timing_markdown
from facecrf_ocio.benchmark.workbench import Result
from facecrf_ocio.benchmark.written import write_tables

Progress = Callable[[int, int], None]


def _silent(done: int, total: int) -> None:
    pass


@dataclass(frozen=True, slots=True)
class SyntheticTable:
    """A finished bench.

    Attributes
    ----------
    rows
        Statistics by protocol and estimator.
    results
        Every case, in the order of the plan.
    text, timing
        The tables for people.
    files
        What was written.
    """

    rows: tuple[Row, ...]
    results: tuple[Result, ...]
    text: str
    timing: str
    files: tuple[Path, ...]


def run_synthetic(
    plan: Plan, output: Path, *, jobs: int = 1, progress: Progress = _silent
) -> SyntheticTable:
    """Measure what is not measured yet, and write the tables.

    Parameters
    ----------
    plan
        What to measure.
    output
        Folder for `cases.jsonl`, which grows case by case and lets a later call go on, and for
        the tables: `table.md`, `table.csv`, `cases.csv`, `results.json` (the same for the same
        plan, however often it was interrupted) and `timing.md`.
    jobs
        Number of processes. A script that calls this needs Python's `if __name__ == "__main__":`.
    progress
        Called with the number of finished cases and of all.

    Raises
    ------
    OutputError
        If the folder cannot be written to.
    SettingsError
        If too few curves are left to fit a held-out prior to.
    """
    _check_folds(plan)
    keys = plan.keys()
    store = Store(output / "cases.jsonl", Result)
    tasks = plan.tasks(keys, store.results)
    done = len(keys) - sum(len(task.cases) for task in tasks)
    progress(done, len(keys))
    for task, results in measure_tasks(plan, tasks, jobs):
        store.append({keys[case]: r for case, r in zip(task.cases, results, strict=True)})
        done += len(results)
        progress(done, len(keys))
    return _write_tables(plan, tuple(store.results[key] for key in keys.values()), output)


def _check_folds(plan: Plan) -> None:
    """Refuse before hours of work what would fail in a worker process."""
    fold_of = plan.fold_of()
    if fold_of is None:
        return
    for fold in sorted(set(fold_of[list(plan.rows)].tolist())):
        fit_held_out(plan.responses, fold_of, fold)


def _write_tables(plan: Plan, results: tuple[Result, ...], output: Path) -> SyntheticTable:
    rows = summarize(results)
    text, timing = markdown(rows), timing_markdown(results)
    files = write_tables(output, text, plan.description(), rows, results)
    return SyntheticTable(rows, results, text, timing, files)
