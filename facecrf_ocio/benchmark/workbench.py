"""One photo on the bench: taken, shown to every estimator, and scored."""

from __future__ import annotations

import hashlib
import time
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from facecrf_ocio.benchmark.cases import HELD_OUT, Case, PhotoCases, Plan
from facecrf_ocio.benchmark.folds import fit_held_out
from facecrf_ocio.benchmark.joint_folds import joint_model
from facecrf_ocio.benchmark.metrics import score
from facecrf_ocio.benchmark.responses import Responses
from facecrf_ocio.benchmark.virtual_camera import count_codes, take_photo
from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.joint import JointModel
from facecrf_ocio.response.model import ResponseModel, dorf_model
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Estimate, Float, Outcome, Photo


@dataclass(frozen=True, slots=True)
class CaseResult:
    """What came of one case.

    Attributes
    ----------
    protocol, estimator, image, row, response, family, kind, fold
        The case; `fold` is None where nothing is held out.
    outcome
        Of the estimate, or `failed` where the estimator broke down.
    answered
        False where there was no curve: then the mean curve of the prior is scored in its place.
    verdict
        What the estimator says of its own answer; empty where it says nothing.
    reason
        In the estimator's words.
    mid, shadows, used, bias_stops, rmse, bias, band_coverage, band_stops
        See `metrics.Score`.
    rmse_red, rmse_green, rmse_blue
        Of each channel.
    expected_mid, expected_shadows
        What the estimate expected of `mid` and `shadows`; None where it does not say.
    seconds
        Time of the estimate, everything from detection on; never compared.
    """

    protocol: str
    estimator: str
    image: str
    row: int
    response: str
    family: str
    kind: str
    fold: int | None
    outcome: str
    verdict: str
    answered: bool
    reason: str
    mid: float
    shadows: float
    used: float | None
    bias_stops: float
    rmse: float
    rmse_red: float
    rmse_green: float
    rmse_blue: float
    bias: float
    band_coverage: float | None
    band_stops: float | None
    expected_mid: float | None
    expected_shadows: float | None
    seconds: float


class Workbench:
    """Measures the cases of a plan; holds what photos have in common.

    Each estimate starts from the photo alone: faces are found anew by every estimator and for
    every response, as a user's call would. Only the photo itself is shared.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._fold_of = plan.fold_of()
        self._fitted = lru_cache(maxsize=None)(self._fit)
        self._linear = lru_cache(maxsize=1)(self._read)

    def measure(self, task: PhotoCases) -> tuple[CaseResult, ...]:
        """Results of a task's cases, in their order."""
        photo = self.photograph(task.image, task.row)
        counts = count_codes(photo)
        return tuple(self._measure(case, photo, counts) for case in task.cases)

    def photograph(self, image: int, row: int) -> Photo:
        """The photo that a camera with this response takes of this image."""
        source, plan = self._linear(image), self._plan
        identity = f"{plan.seed} {plan.images[image].sha256} {row}".encode()
        seed = int.from_bytes(hashlib.sha256(identity).digest()[:16], "big")
        return take_photo(
            source.encoded,
            plan.responses.inverse[row],
            plan.encoding,
            np.random.default_rng(seed),
            source.primaries,
        )

    def model(self, case: Case) -> ResponseModel:
        """The prior of a case."""
        fold = self._fold(case)
        return dorf_model() if fold is None else self._fitted(fold)

    def _judge(self, case: Case) -> ResponseModel | JointModel:
        """What the estimator may know: the prior of the case, or what `joint` has learned."""
        if case.estimator not in ("auto", "joint"):
            return self.model(case)
        return joint_model(self._plan.responses, self._fold(case))

    def _measure(self, case: Case, photo: Photo, counts: np.ndarray) -> CaseResult:
        responses = self._plan.responses
        subject = Subject.of(
            *(responses, case.row, responses.inverse[case.row]),
            protocol=case.protocol,
            image=self._plan.images[case.image].name,
            fold=self._fold(case),
        )
        asked = Asked(
            case.estimator,
            self._plan.settings,
            self._judge(case),
            self.model(case),
            self._plan.prior,
        )
        return measure(subject, photo, counts, asked)

    def _fold(self, case: Case) -> int | None:
        if case.protocol != HELD_OUT or self._fold_of is None:
            return None
        return int(self._fold_of[case.row])

    def _fit(self, fold: int) -> ResponseModel:
        if self._fold_of is None:
            return dorf_model()
        return fit_held_out(self._plan.responses, self._fold_of, fold)

    def _read(self, image: int) -> Photo:
        return replace(self._plan.images[image].read(), scene_linear=True)


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """A photo of known response: the columns of `CaseResult` that tell it, and the truth (3, K)."""

    protocol: str
    image: str
    row: int
    response: str
    family: str
    fold: int | None
    truth: Float
    kind: str = ""

    @classmethod
    def of(
        cls,
        responses: Responses,
        row: int,
        truth: Float,
        *,
        protocol: str,
        image: str,
        fold: int | None,
    ) -> Subject:
        """A photo through one of a file's responses, of which `truth` (3, K) is scored."""
        response, family, kind = responses.names[row], responses.family(row), responses.kind(row)
        return cls(protocol, image, row, response, family, fold, truth, kind)


@dataclass(frozen=True, slots=True, eq=False)
class Asked:
    """An estimator, what it may know, and the prior whose mean stands in where it refuses.

    `told` is what `joint` is told of the response's family.
    """

    estimator: str
    settings: Settings
    model: ResponseModel | JointModel | None = None
    prior: ResponseModel | None = None
    told: str = "auto"


def measure(subject: Subject, photo: Photo, counts: np.ndarray, asked: Asked) -> CaseResult:
    """Show a photo to an estimator and score its answer.

    Parameters
    ----------
    subject
        Which photo it is.
    photo, counts
        The photo, and the pixels of each of its code values as `count_codes` gives them.
    asked
        Who is asked.
    """
    start = time.perf_counter()
    estimate, failure = _estimate(photo, asked)
    seconds = time.perf_counter() - start
    scored = estimate
    if estimate.found is None:
        scored = calibrate(photo, estimator="mean", model=asked.prior)
    errors = score(scored.curve, scored.confidence, subject.truth, counts)
    red, green, blue = errors.rmse_channels
    told = None if scored.confidence is None else scored.confidence.in_stops
    return CaseResult(
        protocol=subject.protocol,
        estimator=asked.estimator,
        image=subject.image,
        row=subject.row,
        response=subject.response,
        family=subject.family,
        kind=subject.kind,
        fold=subject.fold,
        outcome="failed" if failure else str(estimate.outcome),
        verdict=str(estimate.confidence.verdict) if estimate.confidence else "",
        answered=estimate.found is not None,
        reason=failure or estimate.reason,
        mid=errors.mid,
        shadows=errors.shadows,
        used=errors.used,
        bias_stops=errors.bias_stops,
        rmse=errors.rmse,
        rmse_red=red,
        rmse_green=green,
        rmse_blue=blue,
        bias=errors.bias,
        band_coverage=errors.band_coverage,
        band_stops=errors.band_stops,
        expected_mid=None if told is None else told.mid,
        expected_shadows=None if told is None else told.shadows,
        seconds=seconds,
    )


def _estimate(photo: Photo, asked: Asked) -> tuple[Estimate, str]:
    """The estimate, and what broke if the estimator did: one photo must not end a night's run."""
    try:
        estimate = calibrate(
            photo,
            estimator=asked.estimator,
            prior=asked.told,
            settings=asked.settings,
            model=asked.model,
        )
        return estimate, ""
    except Exception as error:
        failure = f"{type(error).__name__}: {error}"
        return Estimate(Outcome.NOT_CALIBRATED, asked.estimator, failure), failure
