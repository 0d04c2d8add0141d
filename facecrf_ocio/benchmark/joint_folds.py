"""What the joint estimator may have learned when a fold of responses is held out.

For the two files of responses that the shipped weights were trained with, in five folds, the
package brings weights that were trained without each fold: DoRF's rows with their guard, and whole
makers of the modern ones. Responses of other files are strangers to the shipped weights anyhow.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from pathlib import Path

from facecrf_ocio.benchmark.responses import Responses
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.joint import JointModel, load_joint, shipped_joint

# Responses that the shipped weights were trained with.
DORF = "45d7b6467f147b6dd99875652bef2d36f0a6ef5cebbd5b8ed33759ee6a4c1fc1"
MODERN = "48ef6804cf515c7d6149677829341e8eb2fe3eba4f6e6eec8128a963dbc32110"
FOLDS = 5


def joint_model(responses: Responses, fold: int | None) -> JointModel:
    """The weights for one fold of some responses; the shipped ones where none is held out.

    Raises
    ------
    SettingsError
        If the responses were trained with and no weights without them exist.
    """
    if fold is None or responses.sha256 not in (DORF, MODERN):
        return shipped_joint()
    if not 0 <= fold < FOLDS:
        raise SettingsError(
            f"{responses.path}: joint was trained with these responses, and there are no weights "
            f"without this fold; use --protocol paper, or --folds {FOLDS}"
        )
    return _held_out("dorf" if responses.sha256 == DORF else "modern", fold)


@cache
def _held_out(family: str, fold: int) -> JointModel:
    name = f"joint_without_{family}{fold}.npz"
    return load_joint(Path(str(files("facecrf_ocio.benchmark") / name)))
