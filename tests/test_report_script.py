"""The report's script: short parts, and nothing in the whole that a linter would find."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from facecrf_ocio.archive.report import page_source

ROOT = Path(__file__).parents[1]
PAGE = Path(page_source.__file__).parent / "page"
PARTS = sorted(PAGE.glob("*.js"))


@pytest.fixture
def script(tmp_path):
    path = tmp_path / "page.js"
    path.write_text(page_source.page_script(), encoding="utf-8")
    return path


def test_parts_are_short_enough_to_be_read():
    lines = {part.name: part.read_text(encoding="utf-8").splitlines() for part in PARTS}
    assert {name for name, text in lines.items() if len(text) >= 150} == set()
    assert {name for name, text in lines.items() if max(map(len, text)) > 100} == set()


def test_every_part_is_in_the_script(script):
    whole = script.read_text(encoding="utf-8")
    assert [part.name for part in PARTS if part.read_text(encoding="utf-8") not in whole] == []


def test_the_script_parses(script):
    if shutil.which("node") is None:
        pytest.skip("Node.js is not here")
    subprocess.run(["node", "--check", script], check=True, timeout=60)


def test_eslint_finds_nothing(script):
    if shutil.which("eslint") is None:
        pytest.skip("ESLint is not here (npm install eslint@9)")
    config = ROOT / ".ci" / "eslint.config.mjs"
    command = ["eslint", "--max-warnings=0", "--config", str(config), script.name]
    said = subprocess.run(
        command, cwd=script.parent, check=False, timeout=60, capture_output=True, text=True
    )
    assert said.returncode == 0, said.stdout + said.stderr
