"""From a photo to the estimate of the paper's method, or of one of its rivals.

The estimator finds terms of one objective in the photo; they are joined with the prior and
minimized over the response model's coefficients (eq. 22), and the solution is turned into a valid
curve. An estimator with a solver of its own answers with its curve instead.
"""

from __future__ import annotations

from facecrf_ocio.estimators import Estimator
from facecrf_ocio.published.answer import Answer, EnergyTerms, FittedCurve, PublishedEstimator
from facecrf_ocio.published.energy.empirical import Empirical
from facecrf_ocio.published.energy.monotonicity import Monotonicity
from facecrf_ocio.published.solve import Weighted, solve
from facecrf_ocio.published.trust import fitted_confidence
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.settings import PublishedSettings
from facecrf_ocio.values import Estimate, Lacking, Outcome, Photo


def published_estimate(
    estimator: Estimator, photo: Photo, model: ResponseModel, settings: PublishedSettings
) -> Estimate:
    """Show a photo to one of `estimators.PUBLISHED`.

    Parameters
    ----------
    estimator
        Its row.
    photo
        Encoded, not scene-linear.
    model
        Response model and prior.
    settings
        Weights and thresholds.
    """
    ask: PublishedEstimator = estimator.load()
    answer: Answer = ask(photo, model, settings)
    if isinstance(answer, Lacking):
        return Estimate(Outcome.NOT_CALIBRATED, estimator.name, answer.reason, answer.remedy)
    if isinstance(answer, EnergyTerms):
        return _minimized(estimator, answer, model, settings)
    return _fitted(estimator, answer, model)


def _fitted(estimator: Estimator, answer: FittedCurve, model: ResponseModel) -> Estimate:
    return Estimate(
        Outcome.CALIBRATED,
        estimator.name,
        answer.summary,
        found=model.inverse_crf(answer.samples),
        confidence=fitted_confidence(estimator, answer.encoded, model),
    )


def _minimized(
    estimator: Estimator, answer: EnergyTerms, model: ResponseModel, settings: PublishedSettings
) -> Estimate:
    objective = (
        Weighted("empirical", 1.0, Empirical(model)),
        Weighted("monotonicity", settings.monotonicity_weight, Monotonicity()),
        *answer.terms,
    )
    solution = solve(model, objective, shared=settings.shared_curve)
    return Estimate(
        Outcome.CALIBRATED,
        estimator.name,
        answer.summary,
        found=model.inverse_crf(model.samples(solution.coefficients)),
        confidence=fitted_confidence(estimator, answer.encoded, model),
        coefficients=solution.coefficients,
        energy=dict(solution.energy),
        faces=answer.faces,
    )
