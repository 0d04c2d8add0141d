"""What a file says of itself: odds for a modern digital response against film and early cameras."""

from __future__ import annotations

from math import log

from facecrf_ocio.values import Camera, Primaries

# Film scanners and their software digitize film, whose responses are DoRF's.
_SCANNERS = (
    *("scan", "nikon ls-", "noritsu", "frontier", "fuji photo film co., ltd. sp-", "fujifilm sp-"),
    *("perfection", "silverfast", "opticfilm", "flextight", "pakon", "negative lab pro"),
)
# [log odds] Of 20 cameras whose curves were solved from exposure stacks, one has a curve that is
# likelier as film's, by a prior that saw none of them: 19 to 1. From e^2 to e^4 the error on curves
# of cameras falls by 3 %, and grows by 9 % where a file that names one holds a picture with film's,
# both on heads `dev_*` through the camera that training has as well.
_MODERN = 3.0
# [log odds] Where nothing is told, film, cameras, and phones are as likely as each other: how often
# each is met, no collection of files at hand says. Against as much for film as for all others, a
# day's photos (600 of heads, 308 of real linear photos; held out) through film's responses err by
# 2 and 6 % more, and all others by 3 and 4 % less, in the shadows by 7 and 9 %.
UNTOLD = log(2.0)
# [log odds] Chosen by judgment: a scanner's file may be of a print, or of another's copy.
_SCANNED = 2.0
# [log odds] Of phones' responses 22 in 24 are likelier as a phone's or webcam's, of published ones
# of cameras 18 in 20 as a camera's, by priors that saw none of their makers: 9 to 1 and 7 to 1. Of
# 17 cameras solved from stacks only 3 are, by a prior without any: those are unlike published ones.
# Nothing at hand has both a known response and a lens or a focal length in its file.
_ODDS = 2.0
# Profiles of phones and cameras of the last decade. Files of all ages have sRGB's and Adobe RGB's,
# which tell nothing.
_RECENT = ("Display P3", "Rec.2020")
# Names by which phones and tablets call themselves in EXIF, make and model in lower case.
_PHONES = (
    *("iphone", "ipad", "pixel", "nexus", "sm-", "gt-i", "galaxy", "xperia", "xq-", "huawei"),
    *("honor", "xiaomi", "redmi", "poco", "oneplus", "oppo", "vivo", "realme", "motorola", "moto "),
    *("nokia", "htc", "lge", "lg-", "zte", "asus_", "fairphone", "shield", "nothing", "tecno"),
)


def phone_leaning(camera: Camera) -> float:
    """Log odds for a phone's response among modern ones; 0 where no camera is named."""
    text = f"{camera.make} {camera.model}".lower()
    if not text.strip():
        return 0.0
    return _ODDS if any(name in text for name in _PHONES) else -_ODDS


def modern_leaning(camera: Camera, primaries: Primaries | None = None) -> float:
    """Log odds for the family `modern`, which is two of three where the file tells nothing.

    Odds for modern ones are measured, those of scanners are a judgment: no collection of files
    with known responses tells how often each family occurs.
    """
    text = f"{camera.make} {camera.model} {camera.software}".lower()
    if any(word in text for word in _SCANNERS):
        return -_SCANNED
    recent = primaries is not None and primaries.name in _RECENT
    return _MODERN if recent or camera.make.strip() or camera.model.strip() else UNTOLD
