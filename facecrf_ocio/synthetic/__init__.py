"""A synthetic portrait with the truth of every intermediate step; needs no downloaded photo."""

from facecrf_ocio.synthetic.photograph import encode, gamma_curve, photograph
from facecrf_ocio.synthetic.render import render_face
from facecrf_ocio.synthetic.spec import Light, SyntheticFace, SyntheticSpec

__all__ = [
    "Light",
    "SyntheticFace",
    "SyntheticSpec",
    "encode",
    "gamma_curve",
    "photograph",
    "render_face",
]
