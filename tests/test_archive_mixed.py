"""A mixed archive: all photos accounted for, and no matter how often the run is killed.

Of sixty photos here; `FACECRF_PHOTOS=1000 pytest -m slow tests/test_archive_mixed.py` takes more.
"""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from archive_photos import ONE, everything, exposed, files, table, write_face
from command_line import CODE, CommandLine, write_noise
from photo_files import enlarge_header, write, write_dng

COUNT = int(os.environ.get("FACECRF_PHOTOS", "60"))
OPTIONS = ("--pool", "camera", "--formats", "spi1d", "--jobs", "2")
ODD = ("two words", "quote \" and '", "$HOME `x`", "line\nbreak", "naïve 写真", "-dash", "#%?*")
TWO = {"Make": "Acme", "Model": "Two", "Software": "2.0"}
KINDS = ("face", "face", "other camera", "no camera", "no face", "corrupt", "huge", "duplicate")
KINDS = (*KINDS, "odd name", "linear", "bracket")


def write_mixed(source: Path, count: int) -> dict[str, str]:
    """Write so many photos; the kind of each by its name."""
    kinds: dict[str, str] = {}
    for number in range(count):
        kind = KINDS[number % len(KINDS)]
        folder = source / f"{number % 7}"
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"{number:04d}.jpg"
        gain = 0.6 + 0.0004 * number
        if kind in ("face", "other camera", "no camera"):
            said = {"face": ONE, "other camera": TWO, "no camera": {}}[kind]
            write_face(path, number % 4, gain=gain, **said)
        elif kind == "no face":
            write_noise(path, seed=number)
        elif kind == "corrupt":
            path = path.with_suffix(".png")
            content = write_noise(path, seed=number).read_bytes()
            path.write_bytes(content[: number % len(content)])
        elif kind == "huge":
            path = path.with_suffix(".png")
            enlarge_header(write_noise(path, seed=number), 100_000, 100_000)
        elif kind == "duplicate":
            shutil.copy(source / f"{(number - 7) % 7}" / f"{number - 7:04d}.jpg", path)
        elif kind == "odd name":
            path = folder / f"{ODD[number % len(ODD)]} {number}.jpg"
            write_face(path, number % 4, gain=gain, **ONE)
        elif kind == "linear":
            path = write_linear(path, number)
        else:  # one exposure of a face and, a second later, another
            write_face(path, 3, gain=gain / 2, **TWO, **exposed(number % 50, 0.0))
            write_face(
                folder / f"{number:04d}b.jpg", 3, gain=gain, **TWO, **exposed(number % 50 + 1, 1.0)
            )
            kinds[f"{folder.name}/{number:04d}b.jpg"] = kind
        kinds[path.relative_to(source).as_posix()] = kind
    return kinds


def write_linear(path: Path, number: int) -> Path:
    if number % 2:
        mosaic = np.random.default_rng(number).integers(0, 65536, (32, 48)).astype(np.float64)
        return write_dng(path.with_suffix(".dng"), mosaic)
    pixels = np.random.default_rng(number).random((20, 30, 3)).astype(np.float32)
    return write(path.with_suffix(".exr"), pixels, oiio.HALF)


@pytest.fixture(scope="module")
def mixed(tmp_path_factory):
    source = tmp_path_factory.mktemp("mixed") / "photos"
    kinds = write_mixed(source, COUNT)
    originals = {path: path.read_bytes() for path in source.rglob("*") if path.is_file()}
    whole = source.parent / "whole"
    command = [sys.executable, "-c", CODE, "batch", str(source), "-o", str(whole), *OPTIONS]
    assert subprocess.run(command, check=False, capture_output=True).returncode == 3
    assert {path: path.read_bytes() for path in originals} == originals
    return source, kinds, whole


@pytest.mark.slow
def test_every_photo_is_accounted_for_by_its_kind(mixed):
    _, kinds, whole = mixed
    rows = {
        name: rest
        for name, *rest in table(
            whole, "SELECT name, state, outcome, curve, reason, duplicate_of FROM photos"
        )
    }
    assert set(rows) == set(kinds)
    assert {state for state, *_ in rows.values()} == {"done"}
    for name, kind in kinds.items():
        _, outcome, curve, reason, twin = rows[name]
        expected = {"corrupt": "failed", "huge": "failed", "linear": "already linear"}
        if kind == "no face":
            assert outcome == "not calibrated"
        else:
            assert outcome == expected.get(kind, "calibrated"), (name, reason)
        if kind == "huge":
            assert "size" in reason or "megapixels" in reason
        if kind in ("face", "odd name", "other camera"):
            assert curve == "camera"
        if kind != "bracket":  # of a thousand photos some brackets are alike to the byte
            assert (twin != "") == (kind == "duplicate"), name
        has_files = outcome in ("calibrated", "already linear")
        assert (whole / f"{name}.spi1d").is_file() == has_files


@pytest.mark.slow
def test_killed_at_ten_moments_and_resumed_it_is_the_same_as_unbroken(mixed, capfd, tmp_path):
    source, _, whole = mixed
    broken = tmp_path / "broken"
    command = [sys.executable, "-c", CODE, "batch", str(source), "-o", str(broken), *OPTIONS]
    chance, kills = random.Random(int(os.environ.get("FACECRF_SEED", "1"))), 0  # noqa: S311
    longest = 6.0 + COUNT / 40.0
    for _ in range(10):
        process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
        try:
            process.wait(chance.uniform(1.0, longest))
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            kills += 1
        process.wait()
    assert kills > 0
    assert CommandLine(capfd)("batch", source, "-o", broken, *OPTIONS).code == 3
    assert everything(broken) == everything(whole)
    assert files(broken) == files(whole)
    assert CommandLine(capfd)("verify", broken).code == 0
