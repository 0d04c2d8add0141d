"""Figures that others have published and that are not measured here.

All are root mean square errors x 100 of the inverse response on uniform encoded values, from
*Radiometric Calibration from Faces in Images* (Li, Lin, Zhou, Ikeuchi, CVPR 2017): the rivals'
code was never published for single images, and neither were the paper's photos.
"""

from __future__ import annotations

from collections.abc import Iterator

from facecrf_ocio.benchmark.peers.peer_table import markdown

_HEAD = ("RMSE x 100", "source", "min", "median", "mean", "max", "std")
_TABLE_1, _TABLE_2 = "published, Table 1", "published, Table 2"
# Table 1: 11 raw photos of faces, each through the 201 responses of DoRF.
_SYNTHETIC = (
    ("EdgeCRF (2004)", 1.10, 27.0, 27.2, 62.4, 12.7),
    ("GICRF (2007)", 0.280, 26.6, 26.2, 65.9, 9.06),
    ("ISCRF (2008)", 0.310, 21.9, 20.9, 44.2, 7.22),
    ("RankCRF (2013)", 0.500, 22.1, 21.6, 44.6, 7.46),
    ("Li et al. (2017) without shading", 0.600, 12.5, 13.4, 33.2, 4.06),
    ("Li et al. (2017)", 0.330, 3.70, 5.28, 32.0, 4.95),
)
# Table 2: 8 cameras, 6 photos of each.
_CAMERAS = (
    ("EdgeCRF (2004)", 5.58, 25.6, 24.5, 44.3, 9.38),
    ("GICRF (2007)", 8.58, 20.1, 23.4, 47.1, 11.0),
    ("ISCRF (2008)", 2.52, 9.18, 10.2, 24.4, 6.39),
    ("RankCRF (2013)", 3.36, 10.8, 13.2, 32.0, 7.86),
    ("Li et al. (2017) without shading", 4.12, 5.65, 5.91, 9.44, 13.2),
    ("Li et al. (2017)", 1.65, 3.45, 3.50, 5.63, 0.955),
)
# On the same 201 responses, without any photo; `tests/test_response_model.py` measures them.
_BLIND = (
    ("mean curve, without the photos", 2.21, 7.10, 8.99, 39.8, 6.7),
    ("sRGB, without the photos", 1.10, 8.76, 9.92, 41.4, 7.3),
)
# `facecrf bench stress`, a day's photos through held-out DoRF responses; see docs/accuracy.md.
_OURS = (
    ("`facecrf calibrate`, rendered heads", "5.8", "13.8"),
    ("`facecrf calibrate`, real photos", "8.7", "21.4"),
)


def published_rows() -> Iterator[str]:
    """Markdown, a line at a time: published, and measured here on other photos."""
    rows = [
        (name, source, *(f"{value:g}" for value in values))
        for source, table in (
            (_TABLE_1, _SYNTHETIC),
            ("measured, the same 201 responses", _BLIND),
            (_TABLE_2, _CAMERAS),
        )
        for name, *values in table
    ]
    rows += [
        (name, "measured, other photos", "", median, "", f"95 %: {high}", "")
        for name, median, high in _OURS
    ]
    yield from markdown(_HEAD, rows)
