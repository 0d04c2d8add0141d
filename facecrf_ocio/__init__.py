"""From one photo with a face to an OCIO transform that makes the photo scene-linear."""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from facecrf_ocio.calibrate import calibrate as calibrate
    from facecrf_ocio.errors import FaceCRFError as FaceCRFError
    from facecrf_ocio.errors import LutError as LutError
    from facecrf_ocio.errors import NotCalibratedError as NotCalibratedError
    from facecrf_ocio.errors import OutputError as OutputError
    from facecrf_ocio.errors import PhotoError as PhotoError
    from facecrf_ocio.errors import SettingsError as SettingsError
    from facecrf_ocio.image.to_exr import linearize_photo as linearize_photo
    from facecrf_ocio.joint import PhotoEvidence as PhotoEvidence
    from facecrf_ocio.joint import conclude as conclude
    from facecrf_ocio.joint import gather as gather
    from facecrf_ocio.joint import misfit as misfit
    from facecrf_ocio.lut.write import write_lut as write_lut
    from facecrf_ocio.pair.calibrate_bracket import calibrate_bracket as calibrate_bracket
    from facecrf_ocio.pair.calibrate_pair import calibrate_pair as calibrate_pair
    from facecrf_ocio.photo.read import read_photo as read_photo
    from facecrf_ocio.record.calibration_record import read_curve as read_curve
    from facecrf_ocio.settings import Settings as Settings
    from facecrf_ocio.together import Together as Together
    from facecrf_ocio.together import calibrate_together as calibrate_together
    from facecrf_ocio.values import Confidence as Confidence
    from facecrf_ocio.values import Estimate as Estimate
    from facecrf_ocio.values import InverseCRF as InverseCRF
    from facecrf_ocio.values import Outcome as Outcome
    from facecrf_ocio.values import Photo as Photo
    from facecrf_ocio.values import Primaries as Primaries
    from facecrf_ocio.values import Verdict as Verdict

__version__ = "0.1.0"

_HOME = {
    "calibrate": "calibrate",
    **dict.fromkeys(("Together", "calibrate_together"), "together"),
    "calibrate_bracket": "pair.calibrate_bracket",
    "calibrate_pair": "pair.calibrate_pair",
    **dict.fromkeys(("PhotoEvidence", "conclude", "gather", "misfit"), "joint"),
    "linearize_photo": "image.to_exr",
    "read_curve": "record.calibration_record",
    "read_photo": "photo.read",
    "write_lut": "lut.write",
    "Settings": "settings",
    **dict.fromkeys(
        (
            "FaceCRFError",
            "LutError",
            "NotCalibratedError",
            "OutputError",
            "PhotoError",
            "SettingsError",
        ),
        "errors",
    ),
    **dict.fromkeys(
        ("Confidence", "Estimate", "InverseCRF", "Outcome", "Photo", "Primaries", "Verdict"),
        "values",
    ),
}

__all__ = [  # noqa: PLE0604
    *sorted(_HOME),
    "__version__",
]


def __getattr__(name: str) -> Any:
    """Import public names when they are first asked for, so that the command starts at once."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__


class _Package(ModuleType):
    """Keeps the name `calibrate` for the function where the import system binds its module."""

    def __setattr__(self, name: str, value: object) -> None:
        if name == "calibrate" and isinstance(value, ModuleType):
            value = value.calibrate
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
