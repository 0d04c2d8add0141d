"""Table 2: photos of real cameras, whose responses are fitted to a linear image of the exposure."""

from __future__ import annotations

import csv
import hashlib
import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.cases import code_digest
from facecrf_ocio.benchmark.store import Store
from facecrf_ocio.benchmark.tables import Row, markdown, summarize
from facecrf_ocio.benchmark.virtual_camera import count_codes
from facecrf_ocio.benchmark.workbench import Asked, CaseResult, Subject, measure
from facecrf_ocio.benchmark.written import write_tables
from facecrf_ocio.errors import FaceCRFError, PhotoError, reason_of
from facecrf_ocio.files.versions import versions
from facecrf_ocio.pair.calibrate_pair import calibrate_pair
from facecrf_ocio.photo.containers.suffixes import RAW_SUFFIXES, suffixes_named
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.settings import Settings

PAIRS = "pairs"
_LINEAR = RAW_SUFFIXES | suffixes_named("OpenEXR", "Radiance HDR")
_ENCODED = suffixes_named("JPEG", "PNG", "TIFF", "WebP")
_GRID = 1024  # encoded values at which curves are compared, as many as a stored response has

Progress = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class Pair:
    """Two pictures of one exposure.

    Attributes
    ----------
    linear, encoded
        The camera's raw file or a linear image, and what the camera made of it.
    """

    linear: Path
    encoded: Path


@dataclass(frozen=True, slots=True)
class PairsTable:
    """A finished bench; `left_out` says in one line each which pairs gave no truth, and why."""

    rows: tuple[Row, ...]
    text: str
    files: tuple[Path, ...]
    left_out: tuple[str, ...]


def find_pairs(source: Path) -> tuple[Pair, ...]:
    """Find pairs.

    Parameters
    ----------
    source
        A folder, in which a camera raw or EXR file and an encoded image of the same name but for
        the suffix are a pair; or a file of two columns, separated by a tab, with the paths of a
        linear and an encoded image relative to that file.

    Raises
    ------
    PhotoError
        If there are none, or the list cannot be read.
    """
    pairs = _listed(source) if source.is_file() else _in_folder(source)
    if not pairs:
        raise PhotoError(
            source,
            "holds no pairs",
            "give a folder with a.dng and a.jpg, or a list of two columns separated by tabs",
        )
    return pairs


def run_pairs(
    pairs: tuple[Pair, ...],
    estimators: tuple[str, ...],
    output: Path,
    settings: Settings,
    progress: Progress,
) -> PairsTable:
    """Fit each pair's truth, show its encoded photo to every estimator, and write the tables.

    Interrupted and started again, it goes on where it was: `cases.jsonl` keeps every photo.

    Raises
    ------
    OutputError
        If the folder cannot be written to.
    PhotoError
        If no pair at all gives a response to compare with.
    """
    store = Store(output / "cases.jsonl", CaseResult)
    keys: dict[str, None] = {}
    left_out = []
    progress(0, len(pairs))
    for number, pair in enumerate(pairs):
        try:
            asked = _keys(pair, estimators, settings)
            if any(key not in store.results for key in asked):
                measured = _measure(pair, number, estimators, settings)
                store.append(dict(zip(asked, measured, strict=True)))
            keys.update(dict.fromkeys(asked))
        except FaceCRFError as error:
            left_out.append(str(error))
        progress(number + 1, len(pairs))
    if not keys:
        raise PhotoError(output, f"no pair gave a response: {left_out[0]}", "give other pairs")
    results = _by_estimator([store.results[key] for key in keys], estimators)
    rows = summarize(results)
    text = markdown(rows) + "".join(f"\nleft out: {line}\n" for line in left_out)
    run = {
        "versions": versions(),
        "code": code_digest(),
        "settings": asdict(settings),
        "pairs": [[pair.linear.name, pair.encoded.name] for pair in pairs],
        "left_out": left_out,
    }
    files = write_tables(output, text, run, rows, results)
    return PairsTable(rows, text, files, tuple(left_out))


def _measure(
    pair: Pair, number: int, estimators: tuple[str, ...], settings: Settings
) -> Iterator[CaseResult]:
    photo = read_photo(pair.encoded)
    fitted = calibrate_pair(read_photo(pair.linear), photo).estimate.curve
    grid = np.linspace(0.0, 1.0, _GRID)
    truth = np.array([np.interp(grid, fitted.encoded, curve) for curve in fitted.linear])
    subject = Subject(
        protocol=PAIRS,
        image=pair.encoded.name,
        row=number,
        response=pair.linear.name,
        family=f"{photo.camera.make} {photo.camera.model}".strip(),
        fold=None,
        truth=truth,
    )
    counts = count_codes(photo)
    for name in estimators:
        yield measure(subject, photo, counts, Asked(name, settings))


def _by_estimator(results: list[CaseResult], estimators: tuple[str, ...]) -> tuple[CaseResult, ...]:
    return tuple(sorted(results, key=lambda r: (estimators.index(r.estimator), r.row)))


def _keys(pair: Pair, estimators: tuple[str, ...], settings: Settings) -> tuple[str, ...]:
    """For each estimator a digest of all that its result depends on."""
    digests = [_digest_of(path) for path in (pair.linear, pair.encoded)]
    keys = []
    for estimator in estimators:
        content = [PAIRS, digests, estimator, asdict(settings), versions(), code_digest()]
        keys.append(hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest())
    return tuple(keys)


def _digest_of(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        problem = reason_of(error)
        raise PhotoError(path, problem, "name a file that can be read") from error


def _in_folder(folder: Path) -> tuple[Pair, ...]:
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    encoded = {(path.parent, path.stem): path for path in files if path.suffix.lower() in _ENCODED}
    return tuple(
        Pair(path, encoded[path.parent, path.stem])
        for path in files
        if path.suffix.lower() in _LINEAR and (path.parent, path.stem) in encoded
    )


def _listed(source: Path) -> tuple[Pair, ...]:
    try:
        text = source.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise PhotoError(source, f"cannot be read as a list: {error}", "give UTF-8 text") from error
    pairs = []
    for number, line in enumerate(csv.reader(text.splitlines(), delimiter="\t"), start=1):
        if not line or line[0].startswith("#"):
            continue
        if len(line) != 2:
            raise PhotoError(
                source,
                f"line {number} has {len(line)} columns",
                "give two: linear image, tab, encoded image",
            )
        pairs.append(Pair(source.parent / line[0], source.parent / line[1]))
    return tuple(pairs)
