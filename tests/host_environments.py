"""Virtual environments with a host inside, made once and kept in ~/.cache/facecrf-tests."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CACHE = Path.home() / ".cache" / "facecrf-tests"


def host_python(name: str, *alternatives: str, base: str = "") -> Path:
    """Python of the environment `name` with the first of the packages that can be installed.

    `base` names another Python than this one. Skips the test, with pip's last word, where the
    environment cannot be made: without a network, or without a wheel for this machine.
    """
    place = CACHE / name
    python = place / "bin" / "python"
    if (place / "ready").is_file() and python.is_file():
        return python
    start = shutil.which(base) if base else sys.executable
    if start is None:
        pytest.skip(f"{name} needs {base}, which is not here")
    subprocess.run([start, "-m", "venv", "--clear", str(place)], check=True)
    said = ""
    for package in alternatives:
        pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", package]
        made = subprocess.run(pip, check=False, capture_output=True, text=True)
        if made.returncode == 0:
            (place / "ready").touch()
            return python
        said = (made.stderr.strip().splitlines() or ["no word from pip"])[-1]
    pytest.skip(f"{name} cannot be installed here: {said}")


BLENDERS = ("5.0.1", "4.5.4", "4.2.0")
"""The newest, and the first module of each of the two versions with long-term support."""


def blender_python(version: str = BLENDERS[0]) -> Path:
    """Python of an environment with Blender as a module, which has wheels for 3.11 only."""
    return host_python(f"bpy-{version}", f"bpy=={version}", base="python3.11")
