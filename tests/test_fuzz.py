"""Readers of files answer any file with a result or with an error of ours, and soon."""

from __future__ import annotations

import random
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent / "fuzz"))

from mutate import mutated

COUNT = 500  # changed files for each of seven readers: two minutes on two cores
FUZZ = Path(__file__).parent / "fuzz" / "fuzz.py"


def test_changes_change_and_can_be_repeated():
    sound = bytes(range(256)) * 4
    made = [mutated(sound, [sound], random.Random(seed)) for seed in range(200)]  # noqa: S311
    assert made == [mutated(sound, [sound], random.Random(seed)) for seed in range(200)]  # noqa: S311
    assert sum(one != sound for one in made) > 190
    assert len(set(made)) > 190


@pytest.mark.slow
def test_no_changed_file_escapes_a_crash_a_hang_or_a_gigabyte(tmp_path):
    """The same files at each run, of those that `python tests/fuzz/fuzz.py` makes without end."""
    command = [sys.executable, FUZZ, "--executions", str(COUNT), "--seconds", "1800"]
    ended = subprocess.run(
        [*command, "--keep", tmp_path], check=False, capture_output=True, text=True
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr
    counts = [int(line.split()[1]) for line in ended.stdout.splitlines()[:-1]]
    assert counts == [COUNT] * 7
