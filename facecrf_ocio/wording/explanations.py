"""What `facecrf explain` says of the words that results use."""

from __future__ import annotations

import textwrap

from facecrf_ocio.estimators import ESTIMATORS

WIDTH = 80  # columns, as most terminals begin with
_GAP = 2  # columns between a word and what it means
_BESIDE = 30  # columns that an explanation needs beside its word, else it goes below

Text = tuple[str | dict[str, str], ...]
"""Paragraphs, and words with what they mean."""

VERDICTS: Text = (
    "A verdict says how far a curve may be trusted.",
    {
        "reliable": "Use it. The error to expect is at most 0.1 stops in the midtones and 0.25 "
        "in the shadows. The curve may be sRGB all the same: whether it differs is said apart "
        "from the verdict.",
        "weak": "A first guess. The photo says something, but little, or its cues contradict "
        "each other, or its file says that no single curve made it. Compare it with sRGB. More "
        "photos of the same camera together, a raw file beside the JPEG, or a bracket make it "
        "surer; where the line tells a doubt, only what it names after it does. Where the file "
        "has lost its camera's name and a digital camera or a phone took the photo, --prior "
        "modern does.",
        "prior only": "Not of this photo: what cameras do on average, or a fixed curve that was "
        "asked for.",
    },
    "The error is the band's, at one standard deviation: in stops at codes 64 to 235 (midtones) "
    "and 16 to 64 (shadows), once the one free factor is out at mid-gray; and over all codes in "
    "percent of white. Plots and reports show the 90 % band.",
)

OUTCOMES: Text = (
    "An outcome says whether there is a curve, and what it rests on.",
    {
        "calibrated": "A curve from this photo's own evidence.",
        "from its camera": "No evidence of its own; the curve of other photos of the same camera.",
        "already linear": "The file (raw, OpenEXR, HDR) holds linear light: use it as it is.",
        "named by the file": "PQ, HLG (ITU-R BT.2100) or a film scan's log: used as the file says.",
        "fallback": "The curve that was asked for where the photo gives none.",
        "not calibrated": "No curve was written. The line says why, and what to do.",
    },
)

EXPOSURE: Text = (
    "Linear light is relative: one photo cannot tell how bright the scene was. White stays 1, "
    "which is why a linear plate looks dark beside an encoded one.",
    {
        "--exposure STOPS": "multiplies the EXR by two to the power of STOPS.",
        "--exposure gray": "brings the geometric mean of the picture's luminance to 0.18.",
        "--exposure skin": "brings the brighter cheek of the widest face to what skin of its "
        "tone usually reflects: 0.40 fair, 0.22 medium, 0.043 dark. The tone is judged by how "
        "bright the cheek came out, half of which may be the exposure. Tell it where you know "
        "it: skin:fair, skin:medium, skin:dark.",
    },
    "The curve and its LUT files stay as they are. The EXR records the factor "
    "(facecrf:exposure), so that it can be taken out again.",
)


def _estimators() -> Text:
    """Every estimator, with what it rests on."""
    rows = {row.name: row.explained for row in ESTIMATORS.values()}
    return ("An estimator turns a photo into a curve.", rows)


_TEXTS = {"verdicts": VERDICTS, "outcomes": OUTCOMES, "exposure": EXPOSURE}
TOPICS = (*_TEXTS, "estimators")


def explanation(topic: str, width: int = WIDTH) -> str:
    """Return the text on one of `TOPICS`, in lines of at most so many columns."""
    text = _estimators() if topic == "estimators" else _TEXTS[topic]
    return "\n".join(
        _listed(part, width) if isinstance(part, dict) else f"{_filled(part, width)}\n"
        for part in text
    )


def _listed(meanings: dict[str, str], width: int) -> str:
    column = max(map(len, meanings)) + _GAP
    if width - column >= _BESIDE:
        return "".join(
            f"{_filled(f'{word:<{column}}{text}', width, column)}\n"
            for word, text in meanings.items()
        )
    return "".join(
        f"{word}\n{textwrap.indent(_filled(text, width - _GAP), ' ' * _GAP)}\n"
        for word, text in meanings.items()
    )


def _filled(text: str, width: int, indent: int = 0) -> str:
    return textwrap.fill(text, width, subsequent_indent=" " * indent, break_on_hyphens=False)
