"""Cues err together in how bright midtones are: less is believed of it than they claim."""

from __future__ import annotations

import numpy as np

from facecrf_ocio.joint.prior import FAMILIES, Message, Posterior
from facecrf_ocio.values import Float

_BRIGHTNESS = 0  # the coefficient that moves midtones most
# Share that is believed of what all cues say of it, where the response is of each family. On real
# photos the cues' errors in it have a correlation of 0.4, on rendered heads, which training has
# most of, of 0.08. With 0.35 heads through cameras are off as before, real scenes by a tenth less
# (docs/evidence/real-photos-with-a-truth.md). Film's curves differ too much to do without, and no
# real photo is at hand whose film is known.
_BELIEVED = {"dorf": 1.0, "camera": 0.35, "phone": 0.35}


def less_sure(posterior: Posterior, message: Message, family: Float) -> Posterior:
    """What is left if only a share of what a message says of brightness is believed.

    Components keep their weights: of which family a response is, cues know by all that they say.

    Parameters
    ----------
    posterior
        After the message.
    message
        Of all cues.
    family
        (K,) index into `FAMILIES` of each component.
    """
    believed = np.array([_BELIEVED[name] for name in FAMILIES])[family.astype(np.intp)]
    too_much = (1.0 - believed) * message.precision[_BRIGHTNESS]
    return _divided(posterior, float(message.mean[_BRIGHTNESS]), too_much)


def _divided(posterior: Posterior, mean: float, precision: Float) -> Posterior:
    """Each component by a Gaussian of brightness with its precision (K,) (Sherman-Morrison)."""
    beside = posterior.covariances[:, :, _BRIGHTNESS]
    factor = precision / (1.0 - precision * beside[:, _BRIGHTNESS])
    moved = factor * (posterior.means[:, _BRIGHTNESS] - mean)
    return Posterior(
        posterior.weights,
        posterior.means + moved[:, None] * beside,
        posterior.covariances + factor[:, None, None] * beside[:, :, None] * beside[:, None, :],
    )
