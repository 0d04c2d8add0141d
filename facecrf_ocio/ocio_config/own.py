"""The config that photos' LUTs are added to where no other is given."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.color.adaptation import rgb_to_xyz
from facecrf_ocio.color.working_space import (
    WORKING_SPACES,
    working_primaries,
    working_space_matrix,
)

REFERENCE = "lin_rec709"
_NAMES = {"aces2065-1": "ACES2065-1", "acescg": "ACEScg"}
_XYZ = "CIE-XYZ-D65"


def own_config(working_space: str) -> Any:
    """A config whose scene reference is linear Rec.709 and whose role `scene_linear` is another.

    Parameters
    ----------
    working_space
        One of `WORKING_SPACES`.
    """
    config = ocio.Config()
    config.setVersion(2, 1)
    config.setDescription("Curves from code values to scene-linear light, made by facecrf.")
    for space in dict.fromkeys((REFERENCE, "aces2065-1", working_space)):
        config.addColorSpace(_linear(space))
    srgb = ocio.ExponentWithLinearTransform(
        gamma=[2.4, 2.4, 2.4, 1.0],
        offset=[0.055, 0.055, 0.055, 0.0],
        direction=ocio.TransformDirection.TRANSFORM_DIR_INVERSE,
    )
    for other in (
        ocio.ColorSpace(name="srgb", encoding="sdr-video", fromReference=srgb),
        ocio.ColorSpace(name="raw", isData=True, encoding="data"),
        ocio.ColorSpace(
            ocio.ReferenceSpaceType.REFERENCE_SPACE_DISPLAY, name=_XYZ, encoding="display-linear"
        ),
    ):
        other.addCategory("file-io")
        config.addColorSpace(other)
    _add_view(config)
    scene_linear = _name(working_space)
    for role, space in {
        "default": "raw",
        "data": "raw",
        "reference": REFERENCE,
        "scene_linear": scene_linear,
        "aces_interchange": _name("aces2065-1"),
        "cie_xyz_d65_interchange": _XYZ,
        "color_picking": "srgb",
        "texture_paint": "srgb",
        "color_timing": "srgb",
        "compositing_log": "srgb",
        "matte_paint": "srgb",
    }.items():
        config.setRole(role, space)
    return config


def matrix_transform(matrix: npt.NDArray[np.float64]) -> Any:
    """A transform by (3, 3)."""
    full = np.eye(4)
    full[:3, :3] = matrix
    return ocio.MatrixTransform(matrix=full.ravel().tolist())


def _name(space: str) -> str:
    return _NAMES.get(space, space)


def _linear(name: str) -> Any:
    space = ocio.ColorSpace(name=_name(name), encoding="scene-linear")
    space.addCategory("working-space")
    if name != REFERENCE:
        primaries = working_primaries(name)
        to_reference = matrix_transform(working_space_matrix(primaries, REFERENCE))
        to = ocio.ColorSpaceDirection.COLORSPACE_DIR_TO_REFERENCE
        space.setTransform(to_reference, to)
    return space


def _add_view(config: Any) -> None:
    """The display, and how scene light is shown on it: as it is."""
    *rgb, white = WORKING_SPACES[REFERENCE]
    to_display = ocio.ViewTransform(
        name="Un-tone-mapped",
        referenceSpace=ocio.ReferenceSpaceType.REFERENCE_SPACE_SCENE,
        fromReference=matrix_transform(rgb_to_xyz(rgb, white)),
    )
    config.addViewTransform(to_display)
    config.addDisplayView("sRGB", "sRGB", "srgb")
    config.addDisplayView("sRGB", "Raw", "raw")
    config.setActiveDisplays("sRGB")
    config.setActiveViews("sRGB, Raw")
