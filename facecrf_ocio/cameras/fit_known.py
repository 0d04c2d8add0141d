"""Make `known.json`: `python -m facecrf_ocio.cameras.fit_known STACKS CHARTS`.

STACKS is a .npz of responses solved from exposure stacks, with `inverse` (N, 3, 1024), `names`,
`maker`, `grade`, `resid_stops`, `spread_stops` (N, 3) and `source`; CHARTS one of responses
measured by photos of charts, with `inverse` (N, K), `names`, `exif` (N, 2) and `photos`, as
`python -m facecrf_ocio.training charts` writes it.
"""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import numpy as np

from facecrf_ocio.cameras.known_cameras import KnownCamera, write_registry
from facecrf_ocio.values import Float

_POINTS = 128
"""Code values at which a curve ships: 16 kB of the wheel less than 256, for differences of 0.003
stops (RMS, the noise of the stacks) where a curve's standard deviation is 0.06 and more."""
_LEAST_SPREAD = 0.06  # [stop] between sets of one camera where only one was solved
# [stop] Of curves by charts from other measurements of the same camera, which three allow: 0.04 to
# 0.08 over codes 64 to 235.
_CHART_SPREAD = 0.08
_SEVERAL = ("CYBERSHOT", "FDMAVICA")  # what many models call themselves
_AGREEING = 3  # photos of a chart that make a measurement of grade B
# What was on in the photos that made a measurement, by the maker's notes that they all have.
_ON = {
    "Canon EOS 550D": "Auto Lighting Optimizer (Standard)",
    "Canon EOS 5D Mark III": "Auto Lighting Optimizer (Standard)",
    "Canon EOS RP": "Auto Lighting Optimizer (Standard)",
    "NIKON D3100": "Active D-Lighting (Auto)",
    "NIKON D3300": "Active D-Lighting (Auto)",
    "ILCE-6400": "Dynamic Range Optimizer (Auto)",
    "SLT-A55V": "Dynamic Range Optimizer (Auto)",
}
# Where photos of one chart move with it: 0.10 stops in the median of pairs, the others 0.001 to
# 0.013. Of these, and of stacks, it is told and no more.
_BENT = ("NIKON D3100",)
_MAKES = {"Samsung-mobile": "samsung", "Sony-mobile": "Sony", "NVIDIA-tablet": "NVIDIA"}


def solved_from_stacks(path: Path) -> list[KnownCamera]:
    """Entries of all responses solved from exposure stacks; green for all channels.

    Red and blue of single stacks are weak, and nothing goes by them.
    """
    with np.load(path) as stored:
        data = {name: stored[name] for name in stored.files}
    at, grid = np.linspace(0.0, 1.0, _POINTS), np.linspace(0.0, 1.0, data["inverse"].shape[2])
    found = []
    for index, name in enumerate(data["names"]):
        green = _rounded(np.interp(at, grid, data["inverse"][index][1].astype(np.float64)))
        told = float(np.nan_to_num(data["spread_stops"][index, 1]))
        spread = float(f"{np.hypot(max(told, _LEAST_SPREAD), data['resid_stops'][index]):.3g}")
        maker = str(data["maker"][index])
        model = str(name).removesuffix(" (exposure stacks)")
        proof = f"exposure stacks {data['source'][index]}{_with_on(model)}"
        found.append(
            KnownCamera(
                _MAKES.get(maker, maker),
                model,
                "",
                "bracket",
                str(data["grade"][index]),
                spread,
                proof,
                (green,) * 3,
            )
        )
    return found


def measured_by_charts(path: Path) -> list[KnownCamera]:
    """Entries of cameras that photos of a chart name, each by a model that is one camera's."""
    with np.load(path) as stored:
        data = {name: stored[name] for name in stored.files}
    at, grid = np.linspace(0.0, 1.0, _POINTS), np.linspace(0.0, 1.0, data["inverse"].shape[1])
    of_model = Counter(model for _, model in data["exif"].tolist())
    found = []
    for index, (make, model) in enumerate(data["exif"].tolist()):
        if not model or model in _SEVERAL or of_model[model] > 1:
            continue
        green = _rounded(np.interp(at, grid, data["inverse"][index].astype(np.float64)))
        photos = int(data["photos"][index])
        proof = f"photos of a chart thorsted/digicam_corpus:{data['names'][index]} ({photos})"
        grade = "B" if photos >= _AGREEING else "C"
        proof += "" if model in _BENT else _with_on(model)
        style = _ON[model] if model in _BENT else ""
        found.append(
            KnownCamera(make, model, style, "chart", grade, _CHART_SPREAD, proof, (green,) * 3)
        )
    return found


def _with_on(model: str) -> str:
    return f", with {_ON[model]}" if model in _ON else ""


def _rounded(row: Float) -> tuple[float, ...]:
    return tuple(float(f"{value:.4g}") for value in row)


if __name__ == "__main__":
    target = Path(__file__).with_name("known.json")
    stacks, charts = map(Path, sys.argv[1:])
    write_registry(
        target, [*solved_from_stacks(stacks), *measured_by_charts(charts)], overwrite=True
    )
