"""What the joint estimator may have learned when a fold of responses is held out.

The shipped weights were trained with four files of responses. Beside the package, a checkout has
weights that were trained without each of five folds of DoRF's rows, with their guard, and without
each of five folds of makers: of published digital responses, of those that were solved from
exposure stacks, and of those measured by charts; a maker is left out of all three. Responses of
other files are strangers to the shipped weights anyhow.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.responses import Responses
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.joint import JointModel, joint_of, shipped_joint

# Responses that the shipped weights were trained with.
DORF = "45d7b6467f147b6dd99875652bef2d36f0a6ef5cebbd5b8ed33759ee6a4c1fc1"
MODERN = "48ef6804cf515c7d6149677829341e8eb2fe3eba4f6e6eec8128a963dbc32110"
STACKS = "143a54389c8b60cf50a4e23200acf9697f923b31d23864aa0bdb27ae0d716071"
CHARTS = "40f367c0675682d4a3dcdd3ea2af6fe5a3848ec63cf5e7eaa50c72546758d525"
FOLDS = 5  # of responses: so many files of weights were fitted without a fifth each
HELD_OUT = Path(__file__).parents[2] / "examples" / "results" / "held_out_joint.npz"
_FILE = {DORF: "dorf", MODERN: "modern", STACKS: "stacks", CHARTS: "charts"}


def joint_model(responses: Responses, fold: int | None) -> JointModel:
    """The weights for one fold of some responses; the shipped ones where none is held out.

    Raises
    ------
    SettingsError
        If the responses were trained with and no weights without them exist here.
    """
    if fold is None or responses.sha256 not in _FILE:
        return shipped_joint()
    if not 0 <= fold < FOLDS:
        raise SettingsError(
            f"{responses.path}: joint was trained with these responses, and there are no weights "
            f"without this fold; use --protocol paper, or --folds {FOLDS}"
        )
    if not HELD_OUT.is_file():
        raise SettingsError(
            f"{responses.path}: joint was trained with these responses, and the weights without "
            "them come with a checkout of the project, not with the package; use --protocol paper"
        )
    return held_out_joint(HELD_OUT, f"{_FILE[responses.sha256]}{fold}")


@cache
def held_out_joint(path: Path, name: str) -> JointModel:
    """One of the models that `training.weights.pack` put into one file."""
    with np.load(path, allow_pickle=False) as stored:
        mine = [key for key in stored.files if key.startswith(f"{name}/")]
        return joint_of({key.removeprefix(f"{name}/"): stored[key] for key in mine})
