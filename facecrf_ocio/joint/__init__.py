"""The estimator `joint`: every cue of the photo, weighed by its own noise, against the prior."""

from facecrf_ocio.joint.conclusion import conclude, misfit
from facecrf_ocio.joint.evidence import PhotoEvidence, gather
from facecrf_ocio.joint.joint_model import JointModel, joint_of, load_joint, shipped_joint

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
