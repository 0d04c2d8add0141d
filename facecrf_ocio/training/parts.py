"""Simulated examples on disk: parts as .npz files, each written whole or not at all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.joint.noise_counts import NoiseCounts
from facecrf_ocio.joint.statistics import CUES, FACE_CUES, counted_statistics
from facecrf_ocio.training.simulate import Example
from facecrf_ocio.values import Float

_COUNTS = tuple(item.name for item in fields(NoiseCounts))
PHONES = ("phone_isp", "webcam")
"""Kinds of camera whose responses are those of the family `phone`."""
_SAMPLE = 256  # pixels of skin that are kept
# What was done to each photo, for tables by condition.
_DONE = ("stops", "full_well", "scale", "jpeg", "blur", "sharpen", "matrix")


@dataclass(frozen=True, slots=True, eq=False)
class Examples:
    """Examples to fit to, N of them.

    Attributes
    ----------
    inverse
        (N, 1024) the truth.
    family, row, mixed_with
        (N,) as `Draw` has them.
    family_of_kind
        (N,) index into `joint.prior.FAMILIES`.
    by_cue
        (N, S) statistics of each cue; NaN where an example does not show it.
    done
        (N,) of each name, what was done to the photo.
    head
        (N,) names.
    """

    inverse: npt.NDArray[np.float32]
    family: npt.NDArray[np.int64]
    row: npt.NDArray[np.int64]
    mixed_with: npt.NDArray[np.int64]
    family_of_kind: npt.NDArray[np.int64]
    by_cue: dict[str, npt.NDArray[np.float32]]
    done: dict[str, Float]
    head: npt.NDArray[np.str_]

    def __len__(self) -> int:
        return len(self.inverse)

    def where(self, chosen: npt.NDArray[np.bool_]) -> Examples:
        """Some of them."""
        return Examples(
            self.inverse[chosen],
            self.family[chosen],
            self.row[chosen],
            self.mixed_with[chosen],
            self.family_of_kind[chosen],
            {cue: values[chosen] for cue, values in self.by_cue.items()},
            {name: values[chosen] for name, values in self.done.items()},
            self.head[chosen],
        )


def write_part(path: Path, examples: Sequence[Example]) -> None:
    """Store what was counted, not what is made of it, so that statistics can be changed later."""
    arrays: dict[str, Any] = {
        "head": np.array([e.head for e in examples]),
        "inverse": np.array([e.drawn.inverse for e in examples], np.float32),
        "family": np.array([e.drawn.family for e in examples]),
        "row": np.array([e.drawn.row for e in examples]),
        "mixed_with": np.array([e.drawn.mixed_with for e in examples]),
        "sample": np.array([_some(e.sample) for e in examples]),
        "face_width": np.array([np.ptp(e.layout.face.landmarks_xyz[:, 0]) for e in examples]),
        "size": np.array([(e.layout.height, e.layout.width) for e in examples]),
    }
    for name in _DONE:
        arrays[name] = np.array([float(getattr(e.process, name)) for e in examples])
    arrays["denoised"] = np.array([e.process.denoise.kind for e in examples])
    arrays["smoothed"] = np.array([e.process.smooth.kind for e in examples])
    for name in _COUNTS:
        for group in ("photo", "skin"):
            values = np.array([getattr(getattr(e, group), name) for e in examples])
            whole = name not in ("blocks", "edges", "soft_edges", "color_lines")
            arrays[f"{group}_{name}"] = (
                np.rint(values).astype(np.uint32) if whole else values.astype(np.float32)
            )
    for cue in FACE_CUES:
        arrays[f"cue_{cue}"] = _stacked([e.of_face.get(cue) for e in examples])
    unfinished = path.with_suffix(".tmp")
    with unfinished.open("wb") as file:
        np.savez_compressed(file, **arrays)
    unfinished.replace(path)


def read_parts(paths: Sequence[Path], kinds: Sequence[str]) -> Examples:
    """Read parts and derive the statistics of each example, one part after another.

    Parameters
    ----------
    paths
        As `write_part` wrote them.
    kinds
        Of camera, of each modern response.

    Raises
    ------
    SettingsError
        If there are none.
    """
    if not paths:
        raise SettingsError("there are no parts of photos to learn from; make them by `simulate`")
    parts = [_read_part(path, np.isin(kinds, PHONES)) for path in paths]
    first = parts[0]
    return Examples(
        np.concatenate([p.inverse for p in parts]),
        np.concatenate([p.family for p in parts]),
        np.concatenate([p.row for p in parts]),
        np.concatenate([p.mixed_with for p in parts]),
        np.concatenate([p.family_of_kind for p in parts]),
        {cue: np.concatenate([p.by_cue[cue] for p in parts]) for cue in CUES},
        {name: np.concatenate([p.done[name] for p in parts]) for name in first.done},
        np.concatenate([p.head for p in parts]),
    )


def _read_part(path: Path, is_phone: npt.NDArray[np.bool_]) -> Examples:
    with np.load(path, allow_pickle=False) as stored:
        arrays = {name: stored[name] for name in stored.files}
    count, film = len(arrays["family"]), arrays["family"] == 0
    counted = [
        counted_statistics(_counts(arrays, "photo", n), _counts(arrays, "skin", n))
        for n in range(count)
    ]
    by_cue = {cue: arrays[f"cue_{cue}"] for cue in FACE_CUES}
    for cue in CUES:
        if cue not in by_cue:
            by_cue[cue] = _stacked([one.get(cue) for one in counted])
    done = {name: arrays[name] for name in (*_DONE, "face_width", "denoised", "smoothed")}
    done["megapixels"] = arrays["size"].prod(axis=1) / 1e6
    return Examples(
        arrays["inverse"],
        arrays["family"],
        arrays["row"],
        arrays["mixed_with"],
        np.where(film, 0, 1 + is_phone[np.where(film, 0, arrays["row"])]),
        by_cue,
        done,
        arrays["head"],
    )


def _counts(arrays: dict[str, Float], group: str, number: int) -> NoiseCounts:
    return NoiseCounts(
        *(np.asarray(arrays[f"{group}_{name}"][number], np.float64) for name in _COUNTS)
    )


def _some(sample: Float) -> npt.NDArray[np.uint16]:
    """A fixed number of pixels of a sample from dark to bright."""
    chosen = np.linspace(0, len(sample) - 1, _SAMPLE).astype(int)
    return np.asarray(np.rint(sample[chosen] * 65535.0), np.uint16)


def _stacked(vectors: Sequence[Float | None]) -> npt.NDArray[np.float32]:
    """(N, S) with NaN for what is missing; (N, 0) if all are."""
    known = [v for v in vectors if v is not None]
    size = len(known[0]) if known else 0
    nothing = np.full(size, np.nan)
    return np.array([nothing if v is None else v for v in vectors], np.float32)
