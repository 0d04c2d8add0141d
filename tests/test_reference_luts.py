"""The LUTs in `luts/` are what their script makes, and clean."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

PROJECT = Path(__file__).parents[1]
SCRIPT = PROJECT / "examples" / "make_reference_luts.py"
NAMES = ("g0", "gamma22", "modern", "rec709", "srgb")


def table(path: Path) -> np.ndarray:
    return np.array(path.read_text().partition("{")[2].partition("}")[0].split(), float)


def test_the_script_makes_them_again(tmp_path: Path) -> None:
    subprocess.run([sys.executable, str(SCRIPT), str(tmp_path)], check=True)
    assert tuple(sorted(p.stem for p in (PROJECT / "luts").glob("*.spi1d"))) == NAMES
    for name in NAMES:
        made, kept = (table(f / f"{name}.spi1d") for f in (tmp_path, PROJECT / "luts"))
        np.testing.assert_allclose(made, kept, rtol=0, atol=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_they_are_clean(name: str) -> None:
    run = "from facecrf_ocio.cli.lint_command import lint; lint()"
    file = PROJECT / "luts" / f"{name}.spi1d"
    ended = subprocess.run([sys.executable, "-c", run, file], capture_output=True, check=False)
    assert (ended.returncode, ended.stdout) == (0, b"1 LUT looked at: nothing is wrong\n")
