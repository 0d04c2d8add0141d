"""OpenColorIO configs that hold the curves of many photos."""

from facecrf_ocio.ocio_config.entries import Entry, name_luts
from facecrf_ocio.ocio_config.find import PhotoLut, find_luts
from facecrf_ocio.ocio_config.staging import NEWEST_OF_BLENDER, profile_version
from facecrf_ocio.ocio_config.write_config import (
    DEFAULT_PHOTO,
    MOST_SPACES,
    VARIABLE,
    VARIABLE_SPACE,
    Form,
    write_config,
)

__all__ = [
    "DEFAULT_PHOTO",
    "MOST_SPACES",
    "NEWEST_OF_BLENDER",
    "VARIABLE",
    "VARIABLE_SPACE",
    "Entry",
    "Form",
    "PhotoLut",
    "find_luts",
    "name_luts",
    "profile_version",
    "write_config",
]
