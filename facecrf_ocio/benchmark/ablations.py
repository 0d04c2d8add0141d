"""`facecrf bench ablations`: which step of the literal method fails, by giving it its answer."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.ablation import ABLATIONS, Ablation, ablate
from facecrf_ocio.benchmark.cases import code_digest
from facecrf_ocio.benchmark.folds import assign_folds, fit_held_out
from facecrf_ocio.benchmark.laid_out import markdown_table
from facecrf_ocio.benchmark.metrics import score
from facecrf_ocio.benchmark.responses import Responses
from facecrf_ocio.benchmark.store import Store
from facecrf_ocio.benchmark.truth import KnownFace
from facecrf_ocio.benchmark.virtual_camera import CameraEncoding, count_codes, take_photo
from facecrf_ocio.benchmark.written import write_cases
from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.files.versions import versions
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Photo

_LEGEND = """\
Error in stops over codes 64 to 235, one free factor taken out at code 128, and RMSE of g x 100 on
1,024 uniform encoded values, mean of the channels, under priors that never saw the tested curve nor
its fold; a refused photo is scored as the prior's mean curve. E_p truth, E_p identity: median of
E_p at the true curve and at the identity over its value at the estimate. truth lowest: share of
photos at which E_p of the true curve is below that of the identity and of the prior's mean curve.\
"""


@dataclass(frozen=True, slots=True, eq=False)
class AblationPlan:
    """What is measured: every ablation, on every face, through every response."""

    faces: tuple[KnownFace, ...]
    responses: Responses
    rows: tuple[int, ...]
    folds: int = 5
    encoding: CameraEncoding = field(default_factory=CameraEncoding)
    settings: Settings = field(default_factory=Settings)
    seed: int = 0


@dataclass(frozen=True, slots=True)
class AblationResult:
    """One case: `reason` is empty where there was an answer; energies are None where not."""

    ablation: str
    image: str
    row: int
    reason: str
    mid: float
    rmse: float
    energy_found: float | None
    energy_truth: float | None
    energy_identity: float | None
    energy_mean: float | None


def run_ablations(
    plan: AblationPlan, output: Path, progress: Callable[[int, int], None] = lambda *_: None
) -> tuple[str, tuple[Path, ...]]:
    """Measure what is not measured yet; returns the table and the files written.

    Raises
    ------
    OutputError
        If the folder cannot be written to.
    """
    store = Store(output / "ablations.jsonl", AblationResult)
    fold_of = assign_folds(plan.responses, plan.folds)

    @cache
    def model(fold: int) -> ResponseModel:
        return fit_held_out(plan.responses, fold_of, fold)

    cases = [(face, row) for face in plan.faces for row in plan.rows]
    results = []
    for number, (face, row) in enumerate(cases):
        progress(number * len(ABLATIONS), len(cases) * len(ABLATIONS))
        keys = [_key(plan, ablation, face, row) for ablation in ABLATIONS]
        if not all(key in store.results for key in keys):
            photo, prior = _photograph(plan, face, row), model(int(fold_of[row]))
            for key, ablation in zip(keys, ABLATIONS, strict=True):
                if key not in store.results:
                    store.append({key: _measure(plan, ablation, face, row, photo, prior)})
        results += [store.results[key] for key in keys]
    progress(len(cases) * len(ABLATIONS), len(cases) * len(ABLATIONS))
    return _write(plan, results, output)


def _photograph(plan: AblationPlan, face: KnownFace, row: int) -> Photo:
    identity = f"{plan.seed} {face.sha256} {row}".encode()
    seed = int.from_bytes(hashlib.sha256(identity).digest()[:16], "big")
    generator = np.random.default_rng(seed)
    return take_photo(face.linear, plan.responses.inverse[row], plan.encoding, generator)


def _measure(
    plan: AblationPlan,
    ablation: Ablation,
    face: KnownFace,
    row: int,
    photo: Photo,
    model: ResponseModel,
) -> AblationResult:
    truth = plan.responses.inverse[row]
    found = ablate(ablation, face, photo, truth, model, plan.settings)
    if isinstance(found, str):
        curve = calibrate(photo, estimator="mean", model=model).curve
        errors = score(curve, None, truth, count_codes(photo))
        energies = (None, None, None, None)
        case = (ablation.name, face.name, row, found)
        return AblationResult(*case, errors.mid, errors.rmse, *energies)
    errors = score(found.curve, None, truth, count_codes(photo))
    case = (ablation.name, face.name, row, "")
    return AblationResult(*case, errors.mid, errors.rmse, *found.pigment_energy)


def _key(plan: AblationPlan, ablation: Ablation, face: KnownFace, row: int) -> str:
    own = [Path(__file__).with_name(name).read_bytes() for name in ("ablation.py", "truth.py")]
    content = json.dumps(
        [
            *(hashlib.sha256(code).hexdigest() for code in own),
            code_digest(),
            versions(),
            asdict(ablation),
            face.sha256,
            plan.responses.sha256,
            row,
            plan.folds,
            asdict(plan.encoding),
            asdict(plan.settings),
            plan.seed,
        ],
        sort_keys=True,
    )
    return hashlib.sha256(content.encode()).hexdigest()


def _write(
    plan: AblationPlan, results: Sequence[AblationResult], output: Path
) -> tuple[str, tuple[Path, ...]]:
    names = list(dict.fromkeys(result.ablation for result in results))
    groups = [[r for r in results if r.ablation == name] for name in names]
    headings = [
        "ablation",
        "stops median",
        "mean",
        "max",
        "RMSE median",
        "mean",
        "max",
        "refused %",
        "E_p truth",
        "E_p identity",
    ]
    cells = [[name, *_cells(group)] for name, group in zip(names, groups, strict=True)]
    photos = len(plan.faces) * len(plan.rows)
    table = markdown_table([*headings, "truth lowest %"], cells)
    text = f"The literal method with steps given their true answer ({photos} photos)\n\n{table}"
    text += f"\n\n{_LEGEND}\n"
    run = {
        "versions": versions(),
        "code": code_digest(),
        "encoding": asdict(plan.encoding),
        "settings": asdict(plan.settings),
        "images": {face.name: face.sha256 for face in plan.faces},
        "responses": {"file": plan.responses.path.name, "rows": list(plan.rows)},
        "folds": plan.folds,
        "seed": plan.seed,
    }
    cases = [asdict(result) for result in results]
    return text, write_cases(output, "ablations", text, run, cases)


def _cells(group: Sequence[AblationResult]) -> list[str]:
    rmse = 100 * np.array([result.rmse for result in group])
    energies = np.array(
        [
            (r.energy_found, r.energy_truth, r.energy_identity, r.energy_mean)
            for r in group
            if r.energy_found is not None
        ],
        dtype=np.float64,
    ).reshape(-1, 4)
    mid = np.array([result.mid for result in group])
    statistics = [f"{value:.2f}" for value in (np.median(mid), mid.mean(), mid.max())]
    statistics += [f"{value:.1f}" for value in (np.median(rmse), rmse.mean(), rmse.max())]
    refused = f"{100 * (1 - len(energies) / len(group)):.0f}"
    if not len(energies):
        return [*statistics, refused, "-", "-", "-"]
    found, truth, identity, mean = energies.T
    lowest = (truth < identity) & (truth < mean)
    return [
        *statistics,
        refused,
        f"{np.median(truth / found):.2f}",
        f"{np.median(identity / found):.2f}",
        f"{100 * lowest.mean():.0f}",
    ]
