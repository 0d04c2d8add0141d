"""What the patches of a ColorChecker Classic reflect, as its makers have published it.

X-Rite, *New color specifications for ColorChecker SG and Classic charts* (2016): CIE L*a*b* for
D50 and the 2 degree observer of charts made since November 2014, and of those before. Here as CIE
xyY, which the package `colour-science` computed of them.
"""

from __future__ import annotations

import numpy as np

from facecrf_ocio.color.adaptation import bradford, rgb_to_xyz
from facecrf_ocio.color.primaries import D50, D65, KNOWN_PRIMARIES
from facecrf_ocio.values import Float

ROWS, COLUMNS = 4, 6  # of patches
GRAYS = np.arange(18, 24)
"""Places of the gray row, from white to black, among the 24 patches row by row."""
EDITIONS = ("2014", "2005")
"""Charts made since November 2014, and before."""

# CIE x, y, Y of dark skin, light skin, blue sky, foliage, blue flower, bluish green; orange,
# purplish blue, moderate red, purple, yellow green, orange yellow; blue, green, red, yellow,
# magenta, cyan. Editions differ by less here than a camera's color does, so that one will do: they
# only tell which way the chart lies.
_COLORS = (
    *((0.4375, 0.3785, 0.0983), (0.4222, 0.3725, 0.3362), (0.2761, 0.2984, 0.1786)),
    *((0.3733, 0.4512, 0.1347), (0.3029, 0.2863, 0.2287), (0.2864, 0.3897, 0.4144)),
    *((0.5281, 0.4053, 0.3126), (0.2324, 0.2112, 0.1091), (0.5044, 0.3271, 0.1890)),
    *((0.3335, 0.2506, 0.0628), (0.3989, 0.5041, 0.4332), (0.4936, 0.4443, 0.4293)),
    *((0.2052, 0.1687, 0.0560), (0.3230, 0.5104, 0.2233), (0.5629, 0.3356, 0.1278)),
    *((0.4678, 0.4760, 0.5993), (0.4213, 0.2669, 0.1895), (0.2091, 0.3027, 0.1806)),
)
# The gray row, by edition.
_GRAYS = {
    "2014": (
        *((0.3489, 0.3642, 0.8807), (0.3456, 0.3599, 0.5900), (0.3441, 0.3592, 0.3649)),
        *((0.3458, 0.3591, 0.1906), (0.3426, 0.3576, 0.0882), (0.3438, 0.3561, 0.0315)),
    ),
    "2005": (
        *((0.3470, 0.3608, 0.9131), (0.3441, 0.3585, 0.5894), (0.3432, 0.3582, 0.3632)),
        *((0.3446, 0.3580, 0.1915), (0.3402, 0.3548, 0.0883), (0.3406, 0.3538, 0.0311)),
    ),
}


def reflectances(edition: str = EDITIONS[0]) -> Float:
    """(24, 3) light of each patch in linear Rec.709, white paper being 1; nowhere below 0.001."""
    x, y, luminance = np.array((*_COLORS, *_GRAYS[edition])).T
    under_d50 = np.stack([x / y, np.ones_like(x), (1.0 - x - y) / y], axis=1) * luminance[:, None]
    red, green, blue, white = KNOWN_PRIMARIES["Rec.709"]
    to_rgb = np.linalg.inv(rgb_to_xyz((red, green, blue), white)) @ bradford(D50, D65)
    return np.asarray(np.maximum(under_d50 @ to_rgb.T, 0.001))
