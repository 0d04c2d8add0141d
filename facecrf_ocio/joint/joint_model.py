"""All that the estimator `joint` has learned, in one value, and the file that ships with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from facecrf_ocio.files.stored_arrays import load_arrays
from facecrf_ocio.joint.messages import Networks, networks_of
from facecrf_ocio.joint.prior import FAMILIES, FamilyPrior, prior_of
from facecrf_ocio.values import Float, frozen


@dataclass(frozen=True, slots=True, eq=False)
class JointModel:
    """All that was learned: the prior, the networks, and how much too narrow the posterior is.

    Attributes
    ----------
    prior
        Families of responses.
    networks
        What the statistics of each cue say.
    band_scale
        Factor on the posterior's deviation that makes bands cover as they say, measured on heads
        that were not trained on.
    stops_scale
        (F, 2) factors on the expected errors in stops over codes 64 to 235 and 16 to 64, for each
        family of the prior, measured on the same: light near black is far from Gaussian in stops,
        and responses of film differ in more ways than those of digital cameras.
    """

    prior: FamilyPrior
    networks: Networks
    band_scale: float = 1.0
    stops_scale: Float = field(default_factory=lambda: np.ones((len(FAMILIES), 2)))


def load_joint(path: Path) -> JointModel:
    """Read a model that `train` wrote."""
    return joint_of(load_arrays(path))


def joint_of(arrays: Mapping[str, Float]) -> JointModel:
    """The model in the arrays of a file of weights."""
    return JointModel(
        prior_of(arrays),
        networks_of(arrays),
        float(arrays["band_scale"]),
        frozen(arrays["stops_scale"]),
    )


@cache
def shipped_joint() -> JointModel:
    """The model that ships."""
    return load_joint(Path(__file__).parent / "joint_model.npz")
