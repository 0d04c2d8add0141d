"""`facecrf bench peers`: peers on the same pictures, trivial answers, and what was published."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest
from command_line import CommandLine

from facecrf_ocio.benchmark.peers.bracket_curves import Brackets
from facecrf_ocio.benchmark.peers.chart_curves import Charts
from facecrf_ocio.benchmark.peers.made_curves import made_curves, some_of
from facecrf_ocio.benchmark.peers.peer_table import as_curve, curve_errors, curve_rows, trivial
from facecrf_ocio.benchmark.peers.published_figures import published_rows
from facecrf_ocio.synthetic import gamma_curve

TRUTHS = list(made_curves().values())


def test_made_curves_run_from_black_to_white_and_are_those_of_their_names():
    for curve in TRUTHS:
        assert (np.diff(curve.linear) > 0).all()
        assert curve.linear[:, [0, -1]].tolist() == [[0.0, 1.0]] * 3
    power = made_curves()["gamma 1.8"]
    assert np.interp(0.5, power.encoded, power.linear[0]) == pytest.approx(0.5**1.8, abs=1e-3)


def test_the_truth_itself_has_no_error_and_a_power_the_one_it_has():
    truth = gamma_curve(2.2)
    right = curve_errors(lambda _: truth, [truth])
    assert (right.mid, right.shadows, right.rmse, right.answered) == (0.0, 0.0, 0.0, 1.0)
    off = curve_errors(trivial(lambda grid: grid**2.0), [truth])
    # 0.2 stops a stop of code, from code 128.
    codes = np.arange(64, 236)
    assert off.mid == pytest.approx(np.abs(0.2 * np.log2(codes / 128)).mean(), abs=0.01)
    refused = curve_errors(lambda _: None, [truth])
    assert refused.answered == 0.0
    assert np.isnan(refused.mid)


def test_what_falls_is_lifted_to_a_curve():
    codes = np.linspace(0, 1, 5)
    found = as_curve(codes, np.array([[1.0, 2.0, 1.5, 4.0, np.inf]] * 3))
    assert (np.diff(found.linear) > 0).all()
    assert found.linear[0, -1] == 1.0


def test_a_peer_that_is_missing_is_one_line_with_its_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "chromacal", None)
    charts, told = Charts(TRUTHS[:1]), []
    lines = list(curve_rows({"chromacal": charts.chromacal}, TRUTHS[:1], told.append))
    assert told == ["chromacal is not installed: pip install 'facecrf-ocio[peers]'"]
    assert len(lines) == 2


def test_published_figures_are_marked_and_stand_beside_ours(capfd):
    ended = CommandLine(capfd)("bench", "peers", "published")
    assert ended.code == 0
    assert "| Li et al. (2017) | published, Table 1 | 0.33 | 3.7 | 5.28 | 32 | 4.95 |" in ended.out
    assert "| sRGB, without the photos | measured" in ended.out
    assert "| `facecrf calibrate`, real photos | measured" in ended.out


def test_our_figures_beside_published_ones_are_those_of_the_page():
    page = Path(__file__).parents[1].joinpath("docs", "accuracy.md").read_text(encoding="utf-8")
    rows = "\n".join(published_rows())
    for kind in ("rendered heads", "real photos"):
        ((median, high),) = re.findall(rf"\| {kind}, DoRF .*\| ([\d.]+) / ([\d.]+) \(", page)
        assert f"{kind} | measured, other photos |  | {median} |  | 95 %: {high} |" in rows


@pytest.mark.slow
def test_steps_of_two_stops_leave_no_waves_in_our_curve():
    """Light wrong in waves of two stops agrees with all such photos: it was 0.17 to 0.33 stops."""
    brackets = Brackets(TRUTHS[:3])
    assert curve_errors(brackets.ours, TRUTHS[:1]).mid < 0.06
    theirs = curve_errors(lambda case: brackets.opencv("Robertson", case), TRUTHS[:1])
    assert theirs.mid > 0.03


@pytest.mark.slow
def test_a_chart_gives_us_and_chromacal_a_curve():
    charts = Charts(TRUTHS[:1])
    ours = curve_errors(charts.ours, TRUTHS[:1])
    assert ours.mid < 0.02
    pytest.importorskip("chromacal")
    theirs = curve_errors(charts.chromacal, TRUTHS[:1])
    assert 0.0 < theirs.mid < 0.1


def test_responses_of_a_file_are_taken_at_even_distances(tmp_path):
    grid = np.linspace(0, 1, 1024)
    inverse = np.array([[grid**power] * 3 for power in (1.5, 1.8, 2.1, 2.4)])
    np.savez(tmp_path / "r.npz", inverse=inverse, names=np.array(list("abcd")))
    first, last = some_of(tmp_path / "r.npz", 2)
    for curve, power in ((first, 1.5), (last, 2.4)):
        assert np.interp(0.5, curve.encoded, curve.linear[0]) == pytest.approx(0.5**power, abs=1e-3)
