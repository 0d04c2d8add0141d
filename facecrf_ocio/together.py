"""Several photos of one camera: one curve, with a tighter band than any of them gives alone."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from facecrf_ocio.checks import typed
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.joint import JointModel, PhotoEvidence, conclude, gather, misfit, shipped_joint
from facecrf_ocio.photo.given import GivenPhoto, photo_given
from facecrf_ocio.settings import JointSettings
from facecrf_ocio.values import Estimate

MISFIT_LIMIT = 1.0
"""Standard deviations from which a photo is taken to have another curve than its group. Of 1,440
photos simulated for training, in groups of twelve of one measured response, 1.9 % had more against
their own group; of 120 photos put into the group of another curve 16 % had more where that is 0.05
to 0.1 away (RMSE), and 42 % where it is 0.1 to 0.2 away, all with weights that never saw the
group's curve."""

# What a file says twice would make the curve look surer than it is.
_COPY = PhotoEvidence({}, np.empty(0), lacking="a photo before it has the same bytes")


@dataclass(frozen=True, slots=True)
class Together:
    """One curve of several photos.

    Attributes
    ----------
    estimate
        The curve.
    misfits
        For each photo, in their order, how far its own evidence lies from the curve, in standard
        deviations; 0 for a photo without evidence. Above `MISFIT_LIMIT` it was probably made with
        another picture style, or edited.
    lacking
        For each photo, why it said nothing; empty for those that did.
    """

    estimate: Estimate
    misfits: tuple[float, ...]
    lacking: tuple[str, ...]


@typed
def calibrate_together(
    photos: Iterable[GivenPhoto],
    *,
    prior: str = "auto",
    settings: JointSettings | None = None,
    model: JointModel | None = None,
) -> Together:
    """Estimate the one curve of photos that one camera took with the same picture settings.

    Photos are asked one after the other, so a generator that reads them keeps only one in memory.

    Parameters
    ----------
    photos
        As `calibrate` takes them; scene-linear ones have no curve to share, and of files with the
        same bytes the first counts.
    prior, settings, model
        As for `calibrate`.

    Raises
    ------
    PhotoError
        If a photo cannot be read, or is none.
    SettingsError
        If the prior is not known, or there is no photo.
    """
    model = model or shipped_joint()
    evidence = []
    files = set()
    for photo in map(photo_given, photos):
        if photo.sha256 is not None and photo.sha256 in files:
            evidence.append(_COPY)
            continue
        files.add(photo.sha256)
        evidence.append(gather(photo, settings, model.networks))
    if not evidence:
        raise SettingsError("no photos to calibrate together; give at least one")
    shared = settings is not None and settings.shared_curve
    estimate = conclude(evidence, prior, model, shared=shared)
    return Together(
        estimate,
        tuple(misfit(one, estimate, model) for one in evidence),
        tuple(one.lacking for one in evidence),
    )
