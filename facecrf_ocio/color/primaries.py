"""RGB primaries that have names."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from facecrf_ocio.checks import span_colors
from facecrf_ocio.values import Primaries

D65 = (0.3127, 0.3290)  # [CIE xy] as ITU-R BT.709 rounds it
D50 = (0.3457, 0.3585)  # [CIE xy] as ISO 22028-2 rounds it
_ACES_WHITE = (0.32168, 0.33767)  # [CIE xy] SMPTE ST 2065-1

# Red, green, blue, white as published: ITU-R BT.709, SMPTE EG 432-1, Adobe RGB (1998),
# ITU-R BT.2020, ISO 22028-2 (ROMM), SMPTE ST 2065-1 (AP0), Academy S-2014-004 (AP1).
KNOWN_PRIMARIES = {
    "Rec.709": ((0.640, 0.330), (0.300, 0.600), (0.150, 0.060), D65),
    "Display P3": ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060), D65),
    "Adobe RGB": ((0.640, 0.330), (0.210, 0.710), (0.150, 0.060), D65),
    "Rec.2020": ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046), D65),
    "ProPhoto": ((0.7347, 0.2653), (0.1596, 0.8404), (0.0366, 0.0001), D50),
    "AP0": ((0.7347, 0.2653), (0.0, 1.0), (0.0001, -0.0770), _ACES_WHITE),
    "AP1": ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044), _ACES_WHITE),
}

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Of red, green and blue of Rec.709; with other primaries luminance differs by < 0.1 stops."""

# The space itself, as primaries of which RGB is XYZ. OpenColorIO's profiles lead there, D65 being
# white; as an attribute of a file the white must be E, or readers would scale the axes.
CIE_XYZ = Primaries("CIE XYZ", (1.0, 0.0), (0.0, 1.0), (0.0, 0.0), (1 / 3, 1 / 3), "ICC profile")

# Profiles round their colorants to 1/65536 of XYZ and their makers' arithmetic differs by some
# 0.001 in xy, while no two sets above are nearer to each other than 0.04.
_SAME_XY = 0.004


def known_primaries(name: str, source: str) -> Primaries:
    """Primaries by name, one of `KNOWN_PRIMARIES`."""
    return Primaries(name, *KNOWN_PRIMARIES[name], source)


def name_primaries(chromaticities: npt.ArrayLike, source: str) -> Primaries | None:
    """Name the known set that (4, 2) CIE xy of red, green, blue, white belong to, or `custom`.

    None if they span no colors: a file that says so says nothing.
    """
    xy = np.asarray(chromaticities, float).reshape(4, 2)
    if not span_colors(xy.tolist()):
        return None
    for name, known in KNOWN_PRIMARIES.items():
        if np.abs(xy - np.array(known)).max() < _SAME_XY:
            return known_primaries(name, source)
    red, green, blue, white = ((float(x), float(y)) for x, y in xy)
    return Primaries("custom", red, green, blue, white, source)
