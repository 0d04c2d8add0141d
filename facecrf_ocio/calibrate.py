"""Start here: one photo in, its inverse camera response out.

Read this page from top to bottom to follow a photo. The default estimator gathers what every cue of
the photo says and multiplies it with the prior (`joint/`). The paper's method and its rivals branch
off to `published/estimate.py`. All of them are listed in `estimators.py`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from facecrf_ocio.checks import typed
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.estimators import (
    ESTIMATORS,
    FALLBACKS,
    FIXED_CURVES,
    JOINT_NAMES,
)
from facecrf_ocio.joint import JointModel, PhotoEvidence, conclude, gather, shipped_joint
from facecrf_ocio.joint.single_curve import gain_scatter
from facecrf_ocio.joint.verdict import doubted
from facecrf_ocio.photo.given import GivenPhoto, photo_given
from facecrf_ocio.response.fixed import fixed_curve, prior_confidence
from facecrf_ocio.response.model import (
    CURVE_SIZE,
    ResponseModel,
    dorf_model,
    strictly_increasing,
)
from facecrf_ocio.response.signal_curves import signal_curve
from facecrf_ocio.settings import PRIORS, Settings
from facecrf_ocio.values import (
    Confidence,
    Estimate,
    InStops,
    InverseCRF,
    Outcome,
    Photo,
    Verdict,
)
from facecrf_ocio.wording.assumption_words import primaries_assumed
from facecrf_ocio.wording.doubts import bent_by, not_single

_Model = TypeVar("_Model")

SAME_CURVE = "the camera applied the same curve to all channels"


@typed
def calibrate(
    photo: GivenPhoto,
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
        As read by `read_photo`, or the path of its file; or an array (H, W, 3) of code values:
        floats in [0, 1], 8-bit or 16-bit integers.
    estimator
        One of `estimators.ESTIMATORS`. `auto` is `joint`, but refuses a photo without evidence,
        which `joint` answers with the mean of the prior unless there is a fallback.
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
        Response model and prior; those that ship by default. A `JointModel` for `auto` and `joint`,
        a `ResponseModel` for the others.
    evidence
        What `gather` said of this photo before; for `auto` and `joint`, which do not ask again.

    Returns
    -------
    Estimate
        Its `outcome` tells whether there is a curve; a photo that cannot be calibrated is an
        outcome with a remedy, not an error.

    Raises
    ------
    PhotoError
        If the photo cannot be read, or is none.
    SettingsError
        If the estimator, the fallback or the prior is not known, or the model is of another
        estimator's kind.
    """
    photo = photo_given(photo)
    settings = settings or Settings()
    if estimator not in ESTIMATORS:
        raise SettingsError(f"no estimator {estimator!r}; known: {', '.join(ESTIMATORS)}")
    if fallback not in FALLBACKS:
        raise SettingsError(f"no fallback {fallback!r}; known: {', '.join(FALLBACKS)}")
    if prior not in PRIORS:
        raise SettingsError(f"no prior {prior!r}; known: {', '.join(PRIORS)}")
    is_joint = estimator in JOINT_NAMES
    joint = _of_kind(JointModel, model if is_joint else None, estimator)
    response = _of_kind(ResponseModel, None if is_joint else model, estimator) or dorf_model()
    if photo.scene_linear:
        return _already_linear(photo)
    if estimator in FIXED_CURVES:
        return _fixed_curve(estimator, photo, response)
    if photo.named_curve:
        return _named_by_file(photo)
    if is_joint:
        joint = joint or shipped_joint()
        evidence = evidence or gather(photo, settings, joint.networks)
        refuse = estimator == "auto" or fallback != "none"
        estimate = _joint(
            photo, evidence, prior, joint, refuse=refuse, shared=settings.shared_curve
        )
    else:
        # SciPy is slow to import, and the default estimator goes without it.
        from facecrf_ocio.published.estimate import published_estimate  # noqa: PLC0415

        estimate = published_estimate(ESTIMATORS[estimator], photo, response, settings)
        estimate = replace(estimate, assumptions=assumptions_of(photo))
    estimate = _doubted(estimate, photo, settings.most_scatter)
    if not is_joint and estimate.confidence is not None:  # `conclude` knows it from the evidence
        told = doubted(estimate.confidence, bent_by(photo.adapted))
        estimate = replace(estimate, confidence=told)
    if estimate.outcome is Outcome.NOT_CALIBRATED and fallback != "none":
        return _fall_back(estimate, fallback, photo, response)
    return estimate


def _of_kind(kind: type[_Model], model: object, estimator: str) -> _Model | None:
    """The model, which must be of the kind that the estimator takes."""
    if model is None or isinstance(model, kind):
        return model
    raise SettingsError(
        f"the estimator {estimator!r} takes a {kind.__name__}, not a {type(model).__name__}"
    )


def _joint(
    photo: Photo,
    evidence: PhotoEvidence,
    prior: str,
    model: JointModel,
    *,
    refuse: bool,
    shared: bool,
) -> Estimate:
    """Every cue of the photo against the prior; without evidence a refusal, or the prior's mean."""
    if not evidence.messages and refuse:
        return Estimate(Outcome.NOT_CALIBRATED, "joint", evidence.lacking, evidence.remedy)
    estimate = conclude([evidence], prior, model, shared=shared)
    return assumed(estimate, photo)


def _doubted(estimate: Estimate, photo: Photo, most_scatter: float) -> Estimate:
    """Never `reliable` where the file says that no single curve of the camera made the photo."""
    told = estimate.confidence
    if told is None:
        return estimate
    found = list(photo.edits)
    scatter = gain_scatter(photo)
    if scatter > most_scatter:
        found.append(f"its gain map strays from every single curve by {scatter:.2f} stops")
    return replace(estimate, confidence=doubted(told, not_single(found)))


def _already_linear(photo: Photo) -> Estimate:
    encoded = np.linspace(0.0, 1.0, CURVE_SIZE)
    identity = InverseCRF(encoded, np.tile(encoded, (3, 1)))
    return Estimate(
        Outcome.ALREADY_LINEAR,
        "none",
        "the file is scene-linear already, so its inverse response is the identity",
        found=identity,
        confidence=_exact(
            identity, Verdict.RELIABLE, "linear by the file's format: nothing was estimated"
        ),
        assumptions=assumptions_of(photo),
    )


def _named_by_file(photo: Photo) -> Estimate:
    """The curve that the file names, exactly; there is nothing to estimate."""
    curve, source, light = signal_curve(photo.named_curve)
    return Estimate(
        Outcome.NAMED,
        "none",
        f"the file names {photo.named_curve} ({source}), used exactly; its light is {light}",
        found=curve,
        confidence=_exact(curve, Verdict.WEAK, f"the curve is exact, but the light is {light}"),
        assumptions=assumptions_of(photo),
    )


def _exact(curve: InverseCRF, verdict: Verdict, reason: str) -> Confidence:
    """Of a curve that was not estimated, and has no error of its own."""
    shape = curve.linear.shape
    free = InStops(np.zeros((3, 256)), 0.0, 0.0)
    return Confidence(np.zeros(shape), np.ones(shape), verdict, (reason,), free)


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


def assumed(estimate: Estimate, photo: Photo) -> Estimate:
    """With what a curve takes for granted: that channels are alike only where they are."""
    alike = () if _apart(estimate) else (SAME_CURVE,)
    return replace(estimate, assumptions=(*assumptions_of(photo), *alike))


def _apart(estimate: Estimate) -> bool:
    found = estimate.found
    return found is not None and bool((found.linear != found.linear[0]).any())


def assumptions_of(photo: Photo) -> tuple[str, ...]:
    """What a curve cannot tell, and what stands in for it."""
    return (
        primaries_assumed(photo.primaries),
        "linear light is relative: exposure is known only up to one scale",
        "the camera applied one curve per channel, alike over the whole photo",
        *(f"of the file: {note}" for note in photo.notes),
    )
