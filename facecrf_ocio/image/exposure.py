"""An anchor for linear light, which one photo tells up to one factor only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from facecrf_ocio.color.primaries import LUMINANCE
from facecrf_ocio.errors import PhotoError, SettingsError
from facecrf_ocio.image.cheek import lit_cheek
from facecrf_ocio.photo.raster.pixels import code_values
from facecrf_ocio.values import Face, InverseCRF, Photo

GRAY, SKIN = "gray", "skin"
USUAL = {"fair": 0.40, "medium": 0.22, "dark": 0.043}
"""Luminous reflectance of skin under D65, from ISETCam's measured spectra."""

_MIDDLE_GRAY = 0.18  # reflectance that meters take a scene to have on average (ISO 2720)
_DARKEST = 2.0**-12  # of white: below it noise decides, and zero has no logarithm
_MOST_STOPS = 16.0  # half floats hold white up to there
_STEP = 4  # every so many pixels are enough for a mean
# How much of a cheek's distance [stop] from medium skin is put down to its tone; the rest is how
# the photo was exposed. Skin spreads by about 1 stop, and so do photos: cheeks of 9 portraits at
# hand have a luminance of 0.22, as medium skin, give or take 1.3 stops for both together.
_TONE_SHARE = 0.5


@dataclass(frozen=True, slots=True)
class Exposure:
    """A factor on linear light.

    Attributes
    ----------
    stops
        Its logarithm to the base of 2.
    told
        What it was found by.
    """

    stops: float
    told: str


def require_exposure(wanted: str) -> None:
    """Raise SettingsError unless `find_exposure` takes this, before any photo is looked at."""
    if wanted not in (GRAY, SKIN, *(f"{SKIN}:{tone}" for tone in USUAL)):
        _stops(wanted)


def find_exposure(
    wanted: str, photo: Photo, curve: InverseCRF, faces: Sequence[Face] = ()
) -> Exposure:
    """Return by how much linear light is to be multiplied.

    Parameters
    ----------
    wanted
        A number of stops; `gray`, which brings the geometric mean of the luminance to 0.18; or
        `skin`, which brings the brighter cheek of the widest face to what skin of its tone usually
        reflects, `USUAL`. The tone is judged by how bright the cheek came out, half of which may be
        the exposure; `skin:fair`, `skin:medium` and `skin:dark` tell it.
    photo, curve
        Whose light it is.
    faces
        Of this photo, if an estimate of it found them; else they are sought.

    Raises
    ------
    SettingsError
        If it is none of them, or more than 16 stops.
    PhotoError
        If a cheek is asked for and there is none.
    """
    if wanted == GRAY:
        return Exposure(float(np.log2(_MIDDLE_GRAY / _mean_luminance(photo, curve))), GRAY)
    kind, _, tone = wanted.partition(":")
    if kind == SKIN and (tone in USUAL or wanted == SKIN):
        return _by_skin(wanted, tone, lit_cheek(photo, curve, faces), photo)
    return Exposure(_stops(wanted), wanted)


def _stops(wanted: str) -> float:
    try:
        stops = float(wanted)
    except ValueError:
        stops = float("nan")
    if not abs(stops) <= _MOST_STOPS:
        raise SettingsError(
            f"no exposure {wanted!r}; give stops from -{_MOST_STOPS:.0f} to {_MOST_STOPS:.0f}, "
            f"{GRAY}, {SKIN}, or {SKIN}: with {', '.join(USUAL)}"
        )
    return stops


def _by_skin(wanted: str, tone: str, cheek: float | None, photo: Photo) -> Exposure:
    if not cheek:
        raise PhotoError(photo.path, "no cheek to expose for is in view", f"expose by {GRAY}")
    usual = USUAL[tone] if tone else _judged(cheek)
    return Exposure(
        float(np.log2(usual / cheek)), f"{wanted}: a cheek of {cheek:.3g} to {usual:.2g}"
    )


def _judged(cheek: float) -> float:
    """What a cheek reflects, by how bright it came out, within what skin does."""
    likely = USUAL["medium"] * (cheek / USUAL["medium"]) ** _TONE_SHARE
    return float(np.clip(likely, USUAL["dark"], USUAL["fair"]))


def _mean_luminance(photo: Photo, curve: InverseCRF) -> float:
    pixels = code_values(np.ascontiguousarray(photo.pixels[::_STEP, ::_STEP]), 8)
    linear = pixels if photo.scene_linear else curve.linearize(pixels)
    luminance = np.maximum(linear @ LUMINANCE, _DARKEST)
    return float(np.exp(np.log(luminance).mean()))
