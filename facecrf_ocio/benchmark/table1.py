"""Table 1: linear images through known responses, and how well each response is recovered."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.benchmark.bench_processes import measure_tasks
from facecrf_ocio.benchmark.cases import Plan
from facecrf_ocio.benchmark.folds import fit_held_out
from facecrf_ocio.benchmark.groups import groups_markdown, percentiles_markdown
from facecrf_ocio.benchmark.store import Store
from facecrf_ocio.benchmark.tables import Row, markdown, summarize, timing_markdown
from facecrf_ocio.benchmark.workbench import CaseResult, Workbench
from facecrf_ocio.benchmark.written import write_tables

Progress = Callable[[int, int], None]
_UNGROUPED: Mapping[str, str] = {}


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
    results: tuple[CaseResult, ...]
    text: str
    timing: str
    files: tuple[Path, ...]


def run_synthetic(
    plan: Plan,
    output: Path,
    *,
    jobs: int = 1,
    progress: Progress = _silent,
    groups: Mapping[str, str] = _UNGROUPED,
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
    groups
        Group of each image by its name, for a table of their errors.

    Raises
    ------
    OutputError
        If the folder cannot be written to.
    SettingsError
        If too few curves are left to fit a held-out prior to.
    """
    _check_folds(plan)
    keys = plan.keys()
    store = Store(output / "cases.jsonl", CaseResult)
    tasks = plan.tasks(keys, store.results)
    done = len(keys) - sum(len(task.cases) for task in tasks)
    progress(done, len(keys))
    for task, results in measure_tasks(Workbench, plan, tasks, jobs):
        store.append({keys[case]: r for case, r in zip(task.cases, results, strict=True)})
        done += len(results)
        progress(done, len(keys))
    results = tuple(store.results[key] for key in keys.values())
    return _write_tables(plan, results, output, groups)


def _check_folds(plan: Plan) -> None:
    """Refuse before hours of work what would fail in a worker process."""
    fold_of = plan.fold_of()
    if fold_of is None:
        return
    for fold in sorted(set(fold_of[list(plan.rows)].tolist())):
        fit_held_out(plan.responses, fold_of, fold)


def _write_tables(
    plan: Plan, results: tuple[CaseResult, ...], output: Path, groups: Mapping[str, str]
) -> SyntheticTable:
    rows, timing = summarize(results), timing_markdown(results)
    tables = (
        markdown(rows),
        percentiles_markdown(results),
        groups_markdown(results, "kind of camera", lambda result: result.kind),
        groups_markdown(results, "maker", lambda result: result.family),
        groups_markdown(results, "portraits", lambda r: groups.get(Path(r.image).name, "")),
    )
    text = "\n".join(table for table in tables if table)
    files = write_tables(output, text, plan.description(), rows, results)
    return SyntheticTable(rows, results, text, timing, files)
