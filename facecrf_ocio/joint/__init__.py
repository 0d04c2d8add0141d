"""The estimator `joint`: every cue of the photo, weighed by its own noise, against the prior."""

from facecrf_ocio.joint.conclusion import (
    JointModel,
    conclude,
    joint_of,
    load_joint,
    misfit,
    shipped_joint,
)
from facecrf_ocio.joint.evidence import PhotoEvidence, gather

__all__ = [
    "JointModel",
    "PhotoEvidence",
    "conclude",
    "gather",
    "joint_of",
    "load_joint",
    "misfit",
    "shipped_joint",
]
