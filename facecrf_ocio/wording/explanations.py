"""What `facecrf explain` says of the words that results use."""

from __future__ import annotations

import textwrap

from facecrf_ocio.estimators import ESTIMATORS

VERDICTS = """\
A verdict says how far a curve may be trusted.

reliable    Use it. The error to expect is at most 0.1 stops in the midtones and 0.25 in
            the shadows. The curve may be sRGB all the same: whether it differs is said
            apart from the verdict.
weak        A first guess. The photo says something, but little, or its cues contradict
            each other. Compare it with sRGB; more photos of the same camera together,
            a raw file beside the JPEG, or a bracket make it surer.
prior only  Not of this photo: what cameras do on average, or a fixed curve that was
            asked for.

The error is the band's, at one standard deviation: in stops at codes 64 to 235
(midtones) and 16 to 64 (shadows), once the one free factor is out at mid-gray; and
over all codes in percent of white. Plots and reports show the 90 % band.
"""

OUTCOMES = """\
An outcome says whether there is a curve, and what it rests on.

calibrated       A curve from this photo's own evidence.
from its camera  No evidence of its own; the curve of other photos of the same camera.
already linear   The file (raw, OpenEXR, HDR) holds linear light: use it as it is.
named by the file  PQ or HLG (ITU-R BT.2100): used exactly as the file says.
fallback         The curve that was asked for where the photo gives none.
not calibrated   No curve was written. The line says why, and what to do.
"""

EXPOSURE = """\
Linear light is relative: one photo cannot tell how bright the scene was. White stays 1,
which is why a linear plate looks dark beside an encoded one.

--exposure STOPS   multiplies the EXR by two to the power of STOPS.
--exposure gray    brings the geometric mean of the picture's luminance to 0.18.
--exposure skin    brings the brighter cheek of the widest face to what skin of its
                   tone usually reflects: 0.40 fair, 0.22 medium, 0.043 dark. The tone
                   is judged by how bright the cheek came out, half of which may be
                   the exposure. Tell it where you know it: skin:fair, skin:medium,
                   skin:dark.

The curve and its LUT files stay as they are. The EXR records the factor
(facecrf:exposure), so that it can be taken out again.
"""


def estimators() -> str:
    """Every estimator in one line."""
    lines = [_hanging(row.name, row.explained) for row in ESTIMATORS.values()]
    return "\n".join(["An estimator turns a photo into a curve.", "", *lines, ""])


def _hanging(name: str, text: str) -> str:
    return textwrap.fill(f"{name:<21}{text}".rstrip(), 88, subsequent_indent=" " * 21)


def explanation(topic: str) -> str:
    """Return the text on one of `TOPICS`."""
    return estimators() if topic == "estimators" else _TEXTS[topic]


_TEXTS = {"verdicts": VERDICTS, "outcomes": OUTCOMES, "exposure": EXPOSURE}
TOPICS = (*_TEXTS, "estimators")
