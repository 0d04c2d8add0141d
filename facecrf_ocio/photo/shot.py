"""What EXIF tells of an exposure: picture settings, time, and how much light was let in."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.photo.decoding.picture import PhotoFile, open_picture

# EXIF 2.32, sec. 4.6.5, and Canon's maker notes: whatever changes the tone curve.
_STYLE = (
    *("Exif:CustomRendered", "Exif:SceneCaptureType", "Exif:Contrast", "Exif:Saturation"),
    *("Exif:Gamma", "Exif:ColorSpace", "Canon:PhotoEffect", "Canon:ColorTone", "Canon:Contrast"),
    *("Canon:Saturation", "Canon:CustomPictureStyleFileName"),
)
_ISO = ("Exif:PhotographicSensitivity", "Exif:ISOSpeedRatings")
_TIMES = (
    ("Exif:DateTimeOriginal", "Exif:SubsecTimeOriginal"),
    ("Exif:DateTimeDigitized", "Exif:SubsecTimeDigitized"),
)


@dataclass(frozen=True, slots=True)
class Shot:
    """What EXIF tells of one exposure.

    Attributes
    ----------
    style
        Picture settings that change the response, as `name=value`; empty if none is told.
    taken
        [s] Since 1970 in the camera's own time zone.
    exposure_s, aperture, iso
        Exposure time [s], f-number, sensitivity. Everything not told is 0.
    """

    style: str = ""
    taken: float = 0.0
    exposure_s: float = 0.0
    aperture: float = 0.0
    iso: float = 0.0


def read_shot(path: Path) -> Shot:
    """Read the EXIF tags of a file; what it does not tell, or tells as nonsense, is left out."""
    source, _ = open_picture(PhotoFile(path))
    if source is None:
        return Shot()
    try:
        spec = source.spec
        said = ((name, spec.getattribute(name)) for name in _STYLE)
        style = "; ".join(
            f"{name}={plain_text(value)}" for name, value in said if value is not None
        )
        iso = next((value for name in _ISO if (value := _number(spec, name))), 0.0)
        return Shot(
            style, _taken(spec), _number(spec, "ExposureTime"), _number(spec, "FNumber"), iso
        )
    finally:
        source.close()


def _number(spec: Any, name: str) -> float:
    value = spec.get_float_attribute(name)
    return float(value) if math.isfinite(value) and value > 0.0 else 0.0


def _taken(spec: Any) -> float:
    for name, fraction in _TIMES:
        text = spec.get_string_attribute(name).strip("\0 ")
        try:
            time = datetime.strptime(text, "%Y:%m:%d %H:%M:%S").replace(tzinfo=timezone.utc)
        except ValueError:
            continue
        digits = spec.get_string_attribute(fraction).strip("\0 ")
        part = float(f"0.{digits}") if digits.isascii() and digits.isdigit() else 0.0
        return time.timestamp() + part
    return 0.0
