"""Start here: one photo in, its inverse camera response out.

Read this page from top to bottom to follow a photo. The default estimator gathers what every cue of
the photo says and multiplies it with the prior (`joint/`). The paper's method and its rivals
(`published/`; `published/face_estimator.py` is the paper's) find terms of one objective in the
photo, join them with the prior, minimize that over the response model's coefficients, and turn the
result into a valid curve.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.joint import JointModel, PhotoEvidence, conclude, gather, shipped_joint
from facecrf_ocio.published.answer import Answer, FittedCurve
from facecrf_ocio.published.energy.empirical import Empirical
from facecrf_ocio.published.energy.monotonicity import Monotonicity
from facecrf_ocio.published.registry import CUES
from facecrf_ocio.published.solve import Weighted, solve
from facecrf_ocio.published.trust import fitted_confidence, prior_confidence
from facecrf_ocio.response.fixed import FIXED_CURVES, fixed_curve
from facecrf_ocio.response.model import (
    CURVE_SIZE,
    ResponseModel,
    dorf_model,
    strictly_increasing,
)
from facecrf_ocio.settings import ESTIMATOR_NAMES, FALLBACKS, PRIORS, Settings
from facecrf_ocio.values import Confidence, Estimate, InverseCRF, Lacking, Outcome, Photo, Verdict

SAME_CURVE = "the camera applied the same curve to all channels"


def calibrate(
    photo: Photo,
    *,
    estimator: str = "auto",
    fallback: str = "none",
    prior: str = "auto",
    settings: Settings | None = None,
    model: ResponseModel | JointModel | None = None,
    evidence: PhotoEvidence | None = None,
) -> Estimate:
    """Estimate the inverse camera response of one photo.

    Parameters
    ----------
    photo
        As read by `read_photo`, or `Photo(encoded=...)` with an array (H, W, 3) in [0, 1].
    estimator
        One of `settings.ESTIMATOR_NAMES`. `auto` is `joint`, but refuses a photo without evidence,
        which `joint` answers with the mean of the prior.
    fallback
        The curve to answer with where the photo gives no evidence: `mean` response, `srgb`, or
        `none` for an estimate without a curve. The outcome says that it was a fallback.
    prior
        Which responses the estimator `joint` expects: `dorf` (film and early cameras), `modern`
        (digital), or `auto`, which weighs them by the photo and by what the file says of itself.
        The others know DoRF alone.
    settings
        Weights and thresholds; the defaults are documented in `Settings`.
    model
        Response model and prior; those that ship by default. A `JointModel` is for `joint`.
    evidence
        What `gather` said of this photo before; for `joint`, which then does not ask again.

    Returns
    -------
    Estimate
        Its `outcome` tells whether there is a curve; a photo that cannot be calibrated is an
        outcome with a remedy, not an error.

    Raises
    ------
    SettingsError
        If the estimator, the fallback or the prior is not known.
    """
    settings = settings or Settings()
    joint = model if isinstance(model, JointModel) else None
    model = model if isinstance(model, ResponseModel) else dorf_model()
    if estimator not in ESTIMATOR_NAMES:
        raise SettingsError(f"no estimator {estimator!r}; known: {', '.join(ESTIMATOR_NAMES)}")
    if fallback not in FALLBACKS:
        raise SettingsError(f"no fallback {fallback!r}; known: {', '.join(FALLBACKS)}")
    if prior not in PRIORS:
        raise SettingsError(f"no prior {prior!r}; known: {', '.join(PRIORS)}")
    if photo.scene_linear:
        return _already_linear(photo)
    if estimator in FIXED_CURVES:
        return _fixed_curve(estimator, photo, model)
    if estimator in ("auto", "joint"):
        joint = joint or shipped_joint()
        evidence = evidence or gather(photo, settings, joint.networks)
        estimate = _joint(photo, estimator, prior, evidence, joint)
    else:
        answer = CUES[estimator](photo, model, settings)
        estimate = _conclude(estimator, answer, photo, model, settings)
    if estimate.outcome is Outcome.NOT_CALIBRATED and fallback != "none":
        return _fall_back(estimate, fallback, photo, model)
    return estimate


def _joint(
    photo: Photo, estimator: str, prior: str, evidence: PhotoEvidence, model: JointModel
) -> Estimate:
    """Every cue of the photo against the prior."""
    if not evidence.messages and estimator == "auto":
        return Estimate(Outcome.NOT_CALIBRATED, "joint", evidence.lacking, evidence.remedy)
    estimate = conclude([evidence], prior, model)
    return replace(estimate, assumptions=(*assumptions_of(photo), SAME_CURVE))


def _conclude(
    name: str, answer: Answer, photo: Photo, model: ResponseModel, settings: Settings
) -> Estimate:
    """From a cue's answer to an estimate: weigh it against the prior, solve, and judge."""
    if isinstance(answer, Lacking):
        return Estimate(Outcome.NOT_CALIBRATED, name, answer.reason, answer.remedy)
    if isinstance(answer, FittedCurve):
        return Estimate(
            Outcome.CALIBRATED,
            name,
            answer.summary,
            found=model.inverse_crf(answer.samples),
            confidence=fitted_confidence(name, answer.encoded, model),
            assumptions=assumptions_of(photo),
        )
    objective = (
        Weighted("empirical", 1.0, Empirical(model)),
        Weighted("monotonicity", settings.monotonicity_weight, Monotonicity()),
        *answer.terms,
    )
    solution = solve(model, objective, shared=settings.shared_curve)
    return Estimate(
        Outcome.CALIBRATED,
        name,
        answer.summary,
        found=model.inverse_crf(model.samples(solution.coefficients)),
        confidence=fitted_confidence(name, answer.encoded, model),
        coefficients=solution.coefficients,
        energy=dict(solution.energy),
        faces=answer.faces,
        assumptions=assumptions_of(photo),
    )


def _already_linear(photo: Photo) -> Estimate:
    encoded = np.linspace(0.0, 1.0, CURVE_SIZE)
    return Estimate(
        Outcome.ALREADY_LINEAR,
        "none",
        "the file is scene-linear already, so its inverse response is the identity",
        found=InverseCRF(encoded, np.tile(encoded, (3, 1))),
        confidence=Confidence(
            np.zeros((3, CURVE_SIZE)),
            np.ones((3, CURVE_SIZE)),
            Verdict.RELIABLE,
            ("linear by the file's format: nothing was estimated",),
        ),
        assumptions=assumptions_of(photo),
    )


def _fixed_curve(name: str, photo: Photo, model: ResponseModel) -> Estimate:
    encoded = np.linspace(0.0, 1.0, CURVE_SIZE)
    curve = strictly_increasing([fixed_curve(name, encoded, model)] * 3)
    return Estimate(
        Outcome.FALLBACK,
        name,
        f"the {name} curve, chosen without looking at the photo",
        "use a photo with a face to estimate its own curve",
        found=InverseCRF(encoded, curve),
        confidence=prior_confidence(model, "the curve does not depend on the photo"),
        assumptions=assumptions_of(photo),
    )


def _fall_back(estimate: Estimate, name: str, photo: Photo, model: ResponseModel) -> Estimate:
    fixed = _fixed_curve(name, photo, model)
    return replace(fixed, reason=f"{estimate.reason}: fell back to the {name} curve")


def assumptions_of(photo: Photo) -> tuple[str, ...]:
    """What a curve cannot tell, and what stands in for it."""
    if photo.primaries is None:
        primaries = "primaries are not known and taken as Rec.709 with a D65 white"
    else:
        primaries = f"primaries are {photo.primaries.name}, from the {photo.primaries.source}"
    return (
        primaries,
        "linear light is relative: exposure is known only up to one scale",
        "the camera applied one curve per channel, alike over the whole photo",
    )
