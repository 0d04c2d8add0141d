"""What is known of the camera that a file names: its measured response, as one more message.

Picture styles and firmware differ, so that a measurement says less of a photo than of the camera:
the message is as wide as measurements of one model by different people and methods lie apart.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from facecrf_ocio.cameras.known_cameras import (
    KnownCamera,
    known_cameras,
    matching,
    shipped_cameras,
)
from facecrf_ocio.cameras.maker_names import camera_name
from facecrf_ocio.joint.cue_weights import shares_at
from facecrf_ocio.joint.prior import FamilyPrior, Message, Posterior
from facecrf_ocio.response.model import strictly_increasing
from facecrf_ocio.values import Float, InverseCRF

STYLES = (0.18, 0.28, 1.2)
"""Standard deviations, in units of the prior's, of one model's coefficients about a measurement:
of the first, the second, and all others. Root mean squares of differences in 19 pairs of
measurements of six models of Nikon and Canon, by stacks and by raw files beside JPEGs, are 0.16,
0.26 and 0.95 to 2.5; cameras of unlike models lie 0.6, 0.9 and 1.0 to 1.9 about their mean. So a
model tells brightness and contrast of its curve, and nothing of its toe and shoulder."""

OTHER_MODELS = (0.6, 0.9, 1.9)
"""The same where the camera bent its curve to the scene: as far as unlike models lie about their
mean. By how much it bends, no published measurement tells."""

_IN_COMMON = 2
"""Coefficients that measurements of one model agree in: the first of `STYLES`."""

_UNIT_STOPS = 0.45
"""[stop] Mean deviation over codes 64 to 235 of a curve whose coefficients deviate by 1."""

_COLOR = 1
"""Channel that stands for all of a camera that ships: green, in which its stacks are surest."""


@dataclass(frozen=True, slots=True, eq=False)
class KnownResponse:
    """What a camera is called, and what its measurements say of a photo's coefficients.

    Attributes
    ----------
    apart
        (3, L) root of light by which each channel departs from all three's mean at the prior's
        grid, by the user's own measurements; 0 where there are none, since red and blue of those
        that ship are weak.
    bent
        Whether a photo that names it has another curve than was measured.
    """

    name: str
    message: Message
    apart: Float
    bent: bool = False

    @property
    def source(self) -> str:
        """What results call it."""
        return f"the measured response of {self.name}"


def known_responses(
    named: Iterable[tuple[str, str]],
    prior: FamilyPrior,
    cameras: Sequence[KnownCamera] | None,
    bent: Collection[tuple[str, str]] = (),
) -> dict[tuple[str, str], KnownResponse]:
    """What was measured of the cameras that photos name, by make and model.

    Parameters
    ----------
    named
        Make and model of each photo.
    prior
        In whose coefficients messages are.
    cameras
        Where to look them up; those that ship and the user's own by default.
    bent
        Make and model where a camera bent its curve to the scene.
    """
    called = {one for one in named if one[1].strip()}
    if not called:
        return {}  # most photos: the registry is not read for them
    listed = known_cameras() if cameras is None else cameras
    found = {one: known_response(listed, *one, prior, bent=one in bent) for one in sorted(called)}
    return {one: known for one, known in found.items() if known is not None}


def known_response(
    cameras: Sequence[KnownCamera],
    make: str,
    model: str,
    prior: FamilyPrior,
    *,
    bent: bool = False,
) -> KnownResponse | None:
    """The measurements of a camera as one message; None if there are none.

    Where the camera bent its curve, in the photo or while it was measured, they say no more than
    those of another model.
    """
    found = matching(cameras, make, model) if model.strip() else ()
    if not found:
        return None
    # What was measured while the camera bent its curve counts where there is nothing else.
    found = tuple(one for one in found if not one.style) or found
    bent = bent or bool(found[0].style)
    sure = np.array([1.0 / (one.spread_stops / _UNIT_STOPS) ** 2 for one in found])
    each = np.array([coefficients(one, prior) for one in found])
    first, second, others = OTHER_MODELS if bent else STYLES
    spread = np.full(each.shape[1], others)
    spread[:_IN_COMMON] = first, second
    return KnownResponse(
        camera_name(found[0].make, found[0].model),
        Message(sure @ each / sure.sum(), 1.0 / (spread**2 + 1.0 / sure.sum())),
        _apart([one for one in found if one not in shipped_cameras()], prior),
        bent,
    )


def share_beside(known: Message, photo: Posterior) -> float:
    """Share of what is known of a camera beside what a photo says; below 1/2 they contradict.

    By brightness and contrast alone, which one model's curves have in common. Its toe and shoulder
    are not told by a measurement, and where a camera's channels differ, their mean has bends that
    no single curve has, so that a photo seemed to contradict what it was taken with.
    """
    offset = (known.mean - photo.mean)[:_IN_COMMON]
    spread = photo.covariance[:_IN_COMMON, :_IN_COMMON] + np.diag(1 / known.precision[:_IN_COMMON])
    return float(shares_at(offset @ np.linalg.solve(spread, offset), _IN_COMMON))


def in_channels(
    found: InverseCRF,
    known: Mapping[tuple[str, str], KnownResponse],
    cameras: Iterable[tuple[str, str]],
    prior: FamilyPrior,
) -> InverseCRF:
    """A curve of all channels, as each channel of the one camera that took the photos has it.

    Parameters
    ----------
    found
        The same in all channels.
    known
        Measurements that the photos do not contradict.
    cameras
        Make and model that each of the photos names.
    prior
        On whose grid departures are.
    """
    taken = [known.get(one) for one in cameras]
    first = taken[0] if taken else None
    if first is None or not first.apart.any():
        return found
    if any(one is None or one.name != first.name for one in taken):
        return found
    apart = [np.interp(found.encoded, prior.grid, row) for row in first.apart]
    roots = np.maximum(np.sqrt(found.linear) + apart, 0.0)
    return replace(found, linear=strictly_increasing(roots**2))


def _apart(own: Sequence[KnownCamera], prior: FamilyPrior) -> Float:
    """(3, L) mean departures of channels in a user's own measurements."""
    if not own:
        return np.zeros((3, prior.grid.size))
    roots = np.array([_roots(one, prior) for one in own]).mean(axis=0)
    return np.asarray(roots - roots.mean(axis=0))


def _roots(camera: KnownCamera, prior: FamilyPrior) -> Float:
    """(3, L) root of light at the prior's grid."""
    curve = camera.curve
    light = [np.interp(prior.grid, curve.encoded, row) for row in curve.linear]
    return np.asarray(np.sqrt(light))


def cameras_named(named: Iterable[tuple[str, str]]) -> tuple[str, ...]:
    """What the cameras that files name are called, each once; those of no name are left out.

    By model alone, whatever its case: programs write one maker's name in several ways.
    """
    models: dict[str, str] = {}
    for make, model in named:
        if model.strip():
            models.setdefault(model.strip().casefold(), camera_name(make.strip(), model.strip()))
    return tuple(models.values())


def coefficients(camera: KnownCamera, prior: FamilyPrior) -> Float:
    """(M,) of the curve of the prior's that is nearest in the root of light."""
    roots = _roots(camera, prior)
    chosen = roots[_COLOR] if camera in shipped_cameras() else roots.mean(axis=0)
    return np.asarray(np.linalg.lstsq(prior.basis.T, chosen - prior.mean, rcond=None)[0])
