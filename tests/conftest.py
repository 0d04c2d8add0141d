"""Shared fixtures."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from command_line import CommandLine
from hypothesis import settings

from facecrf_ocio.benchmark.chart_cameras import chart_cameras

# How long an example takes says what else the machine does; speed is the benchmarks' matter.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")


@pytest.fixture(scope="session")
def development_data() -> Path:
    """Folder of the development data, which the project does not ship."""
    default = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(os.environ.get("FACECRF_DATA", default))
    if not (folder / "crf").is_dir():
        pytest.skip(f"development data are not in {folder}; set FACECRF_DATA")
    return folder


@pytest.fixture
def facecrf(capfd: pytest.CaptureFixture[str]) -> CommandLine:
    """The command, run in this process; it holds that no traceback is printed."""
    return CommandLine(capfd)


@pytest.fixture
def held_out_weights(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of the checkout: the package may be one that is installed, which has none."""
    checkout = Path(__file__).parents[1] / "examples" / "results" / "held_out_joint.npz"
    monkeypatch.setattr("facecrf_ocio.benchmark.joint_folds.HELD_OUT", checkout)


@pytest.fixture
def chart_curves(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The file of cameras measured by charts, of the checkout as well."""
    checkout = Path(__file__).parents[1] / "examples" / "results" / "chart_cameras.npz"
    monkeypatch.setattr("facecrf_ocio.benchmark.chart_cameras.CHART_CAMERAS", checkout)
    chart_cameras.cache_clear()
    yield checkout
    chart_cameras.cache_clear()
