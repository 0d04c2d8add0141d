"""Make `known.json` from responses solved from stacks: `python -m facecrf_ocio.cameras.fit_known`.

The one argument is a .npz with `inverse` (N, 3, 1024), `names`, `maker`, `grade`, `resid_stops`,
`spread_stops` (N, 3) and `source`.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from facecrf_ocio.cameras.known_cameras import KnownCamera, write_registry

_POINTS = 128
"""Code values at which a curve ships: 18 kB of the wheel less than 256, for differences of 0.003
stops (RMS, the noise of the stacks) where a curve's standard deviation is 0.06 and more."""
_LEAST_SPREAD = 0.06  # [stop] between sets of one camera where only one was solved
_MAKES = {"Samsung-mobile": "samsung", "Sony-mobile": "Sony", "NVIDIA-tablet": "NVIDIA"}


def known_of(path: Path) -> list[KnownCamera]:
    """Entries of all responses in the file."""
    with np.load(path) as stored:
        data = {name: stored[name] for name in stored.files}
    at, grid = np.linspace(0.0, 1.0, _POINTS), np.linspace(0.0, 1.0, data["inverse"].shape[2])
    found = []
    for index, name in enumerate(data["names"]):
        rows = tuple(
            tuple(float(f"{v:.4g}") for v in np.interp(at, grid, row))
            for row in data["inverse"][index].astype(np.float64)
        )
        told = float(np.nan_to_num(data["spread_stops"][index, 1]))
        spread = float(f"{np.hypot(max(told, _LEAST_SPREAD), data['resid_stops'][index]):.3g}")
        maker = str(data["maker"][index])
        model = str(name).removesuffix(" (exposure stacks)")
        proof = f"exposure stacks {data['source'][index]}"
        found.append(
            KnownCamera(
                _MAKES.get(maker, maker),
                model,
                "",
                "bracket",
                str(data["grade"][index]),
                spread,
                proof,
                rows,
            )
        )
    return found


if __name__ == "__main__":
    target = Path(__file__).with_name("known.json")
    write_registry(target, known_of(Path(sys.argv[1])), overwrite=True)
