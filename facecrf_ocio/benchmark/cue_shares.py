"""`facecrf bench cues`: what each cue of `joint` earns, and what several photos earn together.

The statistics of a photo do not depend on the weights, so they are measured once and judged again
with a cue left out, with one cue alone, and together with other photos through the same response.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.cases import HELD_OUT, Plan
from facecrf_ocio.benchmark.joint_folds import joint_model
from facecrf_ocio.benchmark.laid_out import markdown_table
from facecrf_ocio.benchmark.metrics import score
from facecrf_ocio.benchmark.workbench import Workbench
from facecrf_ocio.benchmark.written import write_cases
from facecrf_ocio.joint import JointModel, PhotoEvidence, conclude
from facecrf_ocio.joint.evidence import Observation, observe
from facecrf_ocio.joint.statistics import CUES
from facecrf_ocio.response.coverage import COVERAGE_BINS
from facecrf_ocio.values import Float

ALL, ALONE, WITHOUT, TOGETHER = "all", "alone", "without", "together"
# The ends of a 90 % interval are then the quantiles of 5 and 95 %, give or take 0.5 %.
_DRAWS = 2000

LEGEND = """\
In stops over codes 64 to 235, one free factor taken out at code 128; and RMSE of g x 100 on 1,024
uniform encoded values. alone: from one cue and the prior. without: from
all the others. cost: what leaving the cue out adds to the mean error, with the 90 % interval of a
bootstrap over images. together: one curve for all the images through one response, beside the mean
error of the same photos one by one; band: share of codes within the 90 % band in stops."""


@dataclass(frozen=True, slots=True)
class CueResult:
    """One judgment: `image` is empty, and `cue` too, where all images are judged together."""

    use: str
    cue: str
    image: str
    row: int
    mid: float
    rmse: float
    cover: float


def run_cues(
    plan: Plan, output: Path, progress: Callable[[int, int], None] = lambda *_: None
) -> tuple[str, tuple[Path, ...]]:
    """Measure and write `cues.md`, `cues.csv` and `cues.json`; returns the table and the files.

    Parameters
    ----------
    plan
        Images, responses, and the first of its protocols; its estimators do not matter.
    output
        Folder; earlier tables in it are replaced.
    progress
        Called with the number of finished photos and of all.

    Raises
    ------
    OutputError
        If the folder cannot be written to.
    SettingsError
        If there are no weights without a fold of these responses.
    """
    bench = Workbench(plan)
    fold_of = plan.fold_of() if plan.protocols[0] == HELD_OUT else None
    results: list[CueResult] = []
    seen: dict[int, list[Observation]] = {row: [] for row in plan.rows}
    total = len(plan.images) * len(plan.rows)
    for index, image in enumerate(plan.images):
        for number, row in enumerate(plan.rows):
            progress(index * len(plan.rows) + number, total)
            model = joint_model(plan.responses, None if fold_of is None else int(fold_of[row]))
            found = observe(bench.photograph(index, row), plan.settings)
            if not isinstance(found, Observation):
                continue
            seen[row].append(found)
            results += _judge_cues(plan, model, image.name, row, found)
    for row, photos in seen.items():
        model = joint_model(plan.responses, None if fold_of is None else int(fold_of[row]))
        if len(photos) > 1:
            evidence = [_evidence(model, one, CUES) for one in photos]
            results.append(_judge(plan, model, (TOGETHER, "", "", row), evidence))
    progress(total, total)
    return _write(plan, results, output)


def _judge_cues(
    plan: Plan, model: JointModel, image: str, row: int, found: Observation
) -> list[CueResult]:
    chosen: list[tuple[str, str, tuple[str, ...]]] = [(ALL, "", CUES)]
    for cue in CUES:
        if cue in found.statistics.by_cue:
            others = tuple(other for other in CUES if other != cue)
            chosen += [(ALONE, cue, (cue,)), (WITHOUT, cue, others)]
    return [
        _judge(plan, model, (use, cue, image, row), [_evidence(model, found, cues)])
        for use, cue, cues in chosen
    ]


def _evidence(model: JointModel, found: Observation, cues: Sequence[str]) -> PhotoEvidence:
    by_cue = {cue: v for cue, v in found.statistics.by_cue.items() if cue in cues}
    return PhotoEvidence(model.networks.messages(by_cue), np.zeros((3, COVERAGE_BINS)))


def _judge(
    plan: Plan,
    model: JointModel,
    case: tuple[str, str, str, int],
    evidence: Sequence[PhotoEvidence],
) -> CueResult:
    estimate = conclude(evidence, plan.prior, model)
    truth = plan.responses.inverse[case[3]]
    nowhere = np.zeros((3, 256), dtype=np.int64)
    errors = score(estimate.curve, estimate.confidence, truth, nowhere)
    return CueResult(*case, errors.mid, errors.rmse, errors.band_stops or 0.0)


@dataclass(frozen=True, slots=True)
class _Measure:
    """An error of `CueResult` as the tables show it."""

    title: str
    name: str
    factor: float
    digits: int

    def of(self, results: Iterable[CueResult]) -> Float:
        return self.factor * np.array([getattr(result, self.name) for result in results])

    def statistics(self, errors: Float) -> list[str]:
        return [f"{value:.{self.digits}f}" for value in (np.median(errors), errors.mean())]


# Factor and digits of what is told: stops as they are, RMSE in percent.
_MEASURES = (_Measure("stops", "mid", 1.0, 3), _Measure("RMSE x 100", "rmse", 100.0, 2))


def _write(plan: Plan, results: Sequence[CueResult], output: Path) -> tuple[str, tuple[Path, ...]]:
    whole = {(r.image, r.row): r for r in results if r.use == ALL}
    lines = [f"What each cue of joint earns ({plan.protocols[0]}, {len(whole)} photos)"]
    lines += [_table(measure, results, whole) for measure in _MEASURES]
    joined = [r for r in results if r.use == TOGETHER]
    if joined:
        lines.append(_joined(len(plan.images), joined, whole))
    text = "\n\n".join([*lines, LEGEND]) + "\n"
    cases = [asdict(result) for result in results]
    return text, write_cases(output, "cues", text, plan.description(), cases)


def _table(
    measure: _Measure, results: Sequence[CueResult], whole: Mapping[tuple[str, int], CueResult]
) -> str:
    headings = ["alone median", "alone mean", "without median", "without mean", "cost"]
    everything = ["none left out", "", "", *measure.statistics(measure.of(whole.values())), ""]
    cells = [everything, *(_cells(measure, cue, results, whole) for cue in CUES)]
    return markdown_table([measure.title, *headings], cells)


def _joined(
    photos: int, joined: Sequence[CueResult], whole: Mapping[tuple[str, int], CueResult]
) -> str:
    rows = {result.row for result in joined}
    single = [result for (_, row), result in whole.items() if row in rows]
    told = []
    for measure in _MEASURES:
        errors, alone = measure.of(joined), measure.of(single)
        told.append(
            f"{measure.title} {errors.mean():.{measure.digits}f} (median "
            f"{np.median(errors):.{measure.digits}f}) where one photo has "
            f"{alone.mean():.{measure.digits}f}"
        )
    return (
        f"{photos} photos together, {len(joined)} responses: mean error in {', '.join(told)}; the "
        f"90 % band covers {100 * np.mean([r.cover for r in joined]):.0f} %."
    )


def _cells(
    measure: _Measure,
    cue: str,
    results: Sequence[CueResult],
    whole: Mapping[tuple[str, int], CueResult],
) -> list[str]:
    without = [r for r in results if (r.use, r.cue) == (WITHOUT, cue)]
    if not without:
        return [cue, "-", "-", "-", "-", "-"]
    alone = measure.of(r for r in results if (r.use, r.cue) == (ALONE, cue))
    left = measure.of(without)
    costs = left - measure.of(whole[r.image, r.row] for r in without)
    low, high = _interval(costs, [r.image for r in without])
    mean, least, most = (f"{v:+.{measure.digits}f}" for v in (costs.mean(), low, high))
    cost = f"{mean} ({least} to {most})"
    return [cue, *measure.statistics(alone), *measure.statistics(left), cost]


def _interval(costs: Float, images: Sequence[str]) -> tuple[float, float]:
    """90 % interval of the mean, over draws of whole images: their photos err alike."""
    names = sorted(set(images))
    sums = np.array([sum(c for c, i in zip(costs, images, strict=True) if i == n) for n in names])
    counts = np.array([images.count(name) for name in names])
    drawn = np.random.default_rng(0).integers(len(names), size=(_DRAWS, len(names)))
    means = sums[drawn].sum(axis=1) / counts[drawn].sum(axis=1)
    return float(np.quantile(means, 0.05)), float(np.quantile(means, 0.95))
