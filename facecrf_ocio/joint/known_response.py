"""What is known of the camera that a file names: its measured response, as one more message.

Picture styles and firmware differ, so that a measurement says less of a photo than of the camera:
the message is as wide as measurements of one model by different people and methods lie apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from facecrf_ocio.cameras.known_cameras import KnownCamera, matching
from facecrf_ocio.joint.prior import FamilyPrior, Message
from facecrf_ocio.values import Float

STYLES = (0.18, 0.28, 1.2)
"""Standard deviations, in units of the prior's, of one model's coefficients about a measurement:
of the first, the second, and all others. Root mean squares of differences in 19 pairs of
measurements of six models of Nikon and Canon, by stacks and by raw files beside JPEGs, are 0.16,
0.26 and 0.95 to 2.5; cameras of unlike models lie 0.6, 0.9 and 1.0 to 1.9 about their mean. So a
model tells brightness and contrast of its curve, and nothing of its toe and shoulder."""

_UNIT_STOPS = 0.45
"""[stop] Mean deviation over codes 64 to 235 of a curve whose coefficients deviate by 1."""

_COLOR = 1
"""Channel that stands for all: green, in which stacks are surest."""


@dataclass(frozen=True, slots=True, eq=False)
class KnownResponse:
    """What a camera is called, and what its measurements say of a photo's coefficients."""

    name: str
    message: Message


def known_response(
    cameras: Sequence[KnownCamera], make: str, model: str, prior: FamilyPrior
) -> KnownResponse | None:
    """The measurements of a camera as one message; None if there are none."""
    found = matching(cameras, make, model) if model.strip() else ()
    if not found:
        return None
    sure = np.array([1.0 / (one.spread_stops / _UNIT_STOPS) ** 2 for one in found])
    each = np.array([coefficients(one, prior) for one in found])
    first, second, others = STYLES
    spread = np.full(each.shape[1], others)
    spread[:2] = first, second
    return KnownResponse(
        _called(found[0]),
        Message(sure @ each / sure.sum(), 1.0 / (spread**2 + 1.0 / sure.sum())),
    )


def _called(camera: KnownCamera) -> str:
    """Make and model, the make once: many models begin with it."""
    begins = camera.model.casefold().startswith(camera.make.casefold())
    return camera.model if begins else f"{camera.make} {camera.model}"


def coefficients(camera: KnownCamera, prior: FamilyPrior) -> Float:
    """(M,) of the curve of the prior's that is nearest in the root of light."""
    curve = camera.curve
    roots = np.sqrt(np.interp(prior.grid, curve.encoded, curve.linear[_COLOR]))
    return np.asarray(np.linalg.lstsq(prior.basis.T, roots - prior.mean, rcond=None)[0])
