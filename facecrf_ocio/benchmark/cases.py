"""The plan of a bench: its cases, and everything that a case's result depends on."""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path

import facecrf_ocio
from facecrf_ocio.benchmark import joint_folds
from facecrf_ocio.benchmark.folds import GUARD_ROWS, assign_folds
from facecrf_ocio.benchmark.images import LinearImage
from facecrf_ocio.benchmark.responses import Responses
from facecrf_ocio.benchmark.virtual_camera import CameraEncoding
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.estimators import ESTIMATOR_NAMES, FIXED_CURVES
from facecrf_ocio.files.versions import versions
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Index

HELD_OUT, PAPER = "held-out", "paper"
# What a result depends on: the way from an array of code values to a curve, and the bench itself.
_MEASURED = (
    "*.py",
    *(f"{room}/**/*.{kind}" for room in ("face", "joint", "published") for kind in ("py", "npz")),
    *("response/*.py", "response/*.npz", "face/models/*.halves", "face/models/*.onnx"),
    *("photo/raster/pixels.py", "color/primaries.py"),
    *(f"benchmark/{name}.py" for name in ("cases", "folds", "joint_folds", "metrics", "responses")),
    *(f"benchmark/{name}.py" for name in ("conditions", "stress", "stress_camera")),
    *("benchmark/virtual_camera.py", "benchmark/workbench.py"),
)


@dataclass(frozen=True, slots=True)
class Case:
    """One estimate to be made.

    Attributes
    ----------
    protocol
        `held-out` or `paper`.
    estimator
        One of `ESTIMATOR_NAMES`.
    image
        Index into the plan's images.
    row
        Row of the response file.
    """

    protocol: str
    estimator: str
    image: int
    row: int


@dataclass(frozen=True, slots=True)
class PhotoCases:
    """The cases of one photo, which are measured together."""

    image: int
    row: int
    cases: tuple[Case, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """What is measured.

    Attributes
    ----------
    images
        Linear images.
    responses
        The file of responses; the prior is fitted to all of it, less the held-out fold.
    rows
        Rows of it that the images are encoded with.
    estimators
        In the order of the table.
    protocols
        `held-out`, `paper`, or both in this order.
    folds
        Number of folds of the held-out protocol.
    encoding, settings
        Of the camera and of the estimators.
    seed
        Of the noise.
    prior
        What `joint` is told of the responses' family: `auto`, `dorf` or `modern`.
    """

    images: tuple[LinearImage, ...]
    responses: Responses
    rows: tuple[int, ...]
    estimators: tuple[str, ...]
    protocols: tuple[str, ...] = (HELD_OUT, PAPER)
    folds: int = 5
    encoding: CameraEncoding = field(default_factory=CameraEncoding)
    settings: Settings = field(default_factory=Settings)
    seed: int = 0
    prior: str = "auto"

    def cases(self) -> Iterator[Case]:
        """Every case, in the order of the results."""
        for protocol in self.protocols:
            for estimator in self.estimators:
                for image in range(len(self.images)):
                    for row in self.rows:
                        yield Case(protocol, estimator, image, row)

    def tasks(self, keys: Mapping[Case, str], done: Mapping[str, object]) -> tuple[PhotoCases, ...]:
        """The cases whose keys are not among those done, photo by photo."""
        missing: dict[tuple[int, int], list[Case]] = {}
        for case, key in keys.items():
            if key not in done:
                missing.setdefault((case.image, case.row), []).append(case)
        return tuple(PhotoCases(*photo, tuple(missing[photo])) for photo in sorted(missing))

    def fold_of(self) -> Index | None:
        """(N,) fold of each response, None if none is held out."""
        return assign_folds(self.responses, self.folds) if HELD_OUT in self.protocols else None

    def keys(self) -> dict[Case, str]:
        """For each case a digest of all that its result depends on."""
        conditions = self.conditions()
        prior = {PAPER: "shipped", HELD_OUT: [self.folds, GUARD_ROWS]}
        return {
            case: _digest(
                _canonical(
                    conditions,
                    prior[case.protocol],
                    case.estimator,
                    self.images[case.image].name,
                    self.images[case.image].sha256,
                    self.responses.sha256,
                    case.row,
                )
            )
            for case in self.cases()
        }

    def conditions(self) -> dict[str, object]:
        """What all cases have in common and the results depend on."""
        return {
            **common_conditions(),
            "encoding": asdict(self.encoding),
            "settings": asdict(self.settings),
            "seed": self.seed,
            "prior": self.prior,
        }

    def description(self) -> dict[str, object]:
        """Everything needed to repeat the bench."""
        fold_of = self.fold_of()
        return {
            **self.conditions(),
            "estimators": list(self.estimators),
            "protocols": list(self.protocols),
            "images": {image.name: image.sha256 for image in self.images},
            "responses": {
                "file": self.responses.path.name,
                "sha256": self.responses.sha256,
                "count": len(self.responses.inverse),
                "rows": list(self.rows),
            },
            "held_out": None
            if fold_of is None
            else {
                "folds": int(fold_of.max()) + 1,
                "by": "contiguous rows" if self.responses.families is None else "maker",
                "guard_rows": GUARD_ROWS if self.responses.families is None else 0,
                "fold_of_row": fold_of.tolist(),
            },
        }


def choose_estimators(names: str) -> tuple[str, ...]:
    """Estimators by `all` or a list with commas; the fixed answers always join them, at the end.

    Raises
    ------
    SettingsError
        If one is not known.
    """
    known = [name for name in ESTIMATOR_NAMES if name not in FIXED_CURVES]
    asked = [name.strip() for name in names.split(",") if name.strip()]
    unknown = sorted(set(asked) - set(ESTIMATOR_NAMES) - {"all"})
    if unknown or not asked:
        problem = f"no estimator {', '.join(unknown) or 'named'}"
        raise SettingsError(f"{problem}; known: all, {', '.join(ESTIMATOR_NAMES)}")
    # What `auto` stands for is in the table under its own name.
    chosen = [name for name in known if name in asked or ("all" in asked and name != "auto")]
    return (*chosen, *FIXED_CURVES)


def common_conditions() -> dict[str, object]:
    """What the results of any bench depend on."""
    return {"versions": versions(), "machine": platform.machine(), "code": code_digest()}


@cache
def code_digest() -> str:
    """Digest of the files of this package that a result depends on: code, models, weights."""
    root = Path(facecrf_ocio.__file__).parent
    total = hashlib.sha256()
    measured = {path for pattern in _MEASURED for path in root.glob(pattern)}
    measured |= {path for path in (joint_folds.HELD_OUT,) if path.is_file()}
    for path in sorted(measured):
        total.update(path.relative_to(root.parent).as_posix().encode())
        total.update(hashlib.sha256(path.read_bytes()).digest())
    return total.hexdigest()


def _canonical(*values: object) -> bytes:
    return json.dumps(values, sort_keys=True).encode()


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
