"""The files of weights: what is in them, and what they say of how they were made."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from facecrf_ocio.files.smooth_arrays import SMOOTH, smooth_bytes
from facecrf_ocio.joint.familiarity import Familiarity
from facecrf_ocio.joint.prior import FAMILIES, FamilyPrior, triangles
from facecrf_ocio.joint.whole_steps import STEP
from facecrf_ocio.values import Float

_IN_BYTES = re.compile(r"_(weight\d|axes)$")
_FINEST = 31  # whole steps on each side of zero: less than bytes hold, and so smaller in a wheel
_PACKAGES = ("facecrf_ocio.joint", "facecrf_ocio.training", "facecrf_ocio.face")


def save_joint(
    path: Path,
    prior: FamilyPrior,
    members: Sequence[Mapping[str, Float]],
    familiarity: Familiarity,
    made_by: str,
) -> None:
    """Write prior and networks as one .npz, the networks' weights in bytes.

    Parameters
    ----------
    path
        To write.
    prior, members
        As `training.fit` makes them.
    familiarity
        Of the statistics in training.
    made_by
        What `describe` tells.
    """
    arrays: dict[str, Any] = _mixture(prior) | {
        f"prior_{name}{SMOOTH}": smooth_bytes(getattr(prior, name)) for name in ("mean", "basis")
    }
    for number, member in enumerate(members):
        for name, value in member.items():
            cue, part = name.split("/")
            if part in ("center", "scale"):  # the same of all members
                arrays[f"{cue}_{part}"] = value.astype(np.float32)
            else:
                arrays[f"{cue}_{number}_{part}"] = value.astype(np.float16)
    arrays |= {
        "ensemble": np.array(len(members)),
        "band_scale": np.array(1.0),
        "stops_scale": np.ones((len(FAMILIES), 2)),
        "made_by": np.array(made_by),
        "familiarity_axes": familiarity.axes.astype(np.float16),
        "familiarity_spread": familiarity.spread.astype(np.float32),
        "familiarity_beside": np.array(familiarity.beside),
        "familiarity_usual": np.array(familiarity.usual),
    }
    _write(path, arrays)


def pack(path: Path, made: Mapping[str, Path]) -> None:
    """Several files of weights as one, each array under `NAME/array`."""
    arrays: dict[str, Any] = {}
    for name, part in made.items():
        with np.load(part, allow_pickle=False) as stored:
            arrays |= {f"{name}/{key}": stored[key] for key in stored.files}
    _write(path, arrays)


def with_band(path: Path, band_scale: float, stops_scale: Float, measured: str) -> None:
    """Set what `JointModel` scales errors by in a file of weights, packed or not.

    `measured` is the command that they were measured with.
    """
    told = {
        "band_scale": np.array(round(band_scale, 2)),
        "stops_scale": np.round(stops_scale, 2),
    }
    with np.load(path, allow_pickle=False) as stored:
        arrays: dict[str, Any] = {name: stored[name] for name in stored.files}
    for name, value in arrays.items():
        last = name.rpartition("/")[2]
        if last in told:
            arrays[name] = told[last]
        elif last == "made_by":
            made_by = json.loads(str(value) or "{}") | {"band_measured": measured}
            arrays[name] = np.array(json.dumps(made_by, sort_keys=True))
    _write(path, arrays)


def _mixture(prior: FamilyPrior) -> dict[str, Float]:
    stored = {
        "prior_weights": prior.weights,
        "prior_means": prior.means,
        "prior_covariances": triangles(prior.covariances),
        "prior_family": prior.family,
    }
    return {name: np.asarray(array, np.float32) for name, array in stored.items()}


def _write(path: Path, arrays: Mapping[str, Any]) -> None:
    """One .npz, each matrix of weights as whole steps in bytes, with a step for every unit.

    Of 120 simulated photos the mean error over the tones is 0.0887 stops with 31 steps on each
    side of zero, 0.0885 with 63 and 0.0883 with 15.
    """
    stored: dict[str, Any] = {}
    for name, value in arrays.items():
        if _IN_BYTES.search(name) and value.dtype != np.int8:
            exact = np.asarray(value, np.float64)
            step = np.abs(exact).max(axis=1, keepdims=True) / _FINEST
            step[step == 0.0] = 1.0
            stored[name] = np.rint(exact / step).astype(np.int8)
            stored[f"{name}{STEP}"] = step.astype(np.float32)
        else:
            stored[name] = value
    np.savez(path, **stored)  # a wheel compresses all arrays at once, and by 10 kB better


def describe(made: Mapping[str, Any]) -> str:
    """JSON of what weights were made with, and the digest of the code that made them."""
    return json.dumps({**made, "code_sha256": _code_digest()}, sort_keys=True)


def _code_digest() -> str:
    """Of everything between a linear picture and the weights, by the names of its modules."""
    digest = hashlib.sha256()
    for package in _PACKAGES:
        for module in sorted(Path(str(files(package))).glob("*.py")):
            digest.update(module.name.encode() + module.read_bytes())
    return digest.hexdigest()
