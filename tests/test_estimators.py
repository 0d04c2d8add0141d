"""One row adds an estimator: the command, the help and the docs know it by it."""

from __future__ import annotations

import inspect
import re
from dataclasses import replace
from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner

from facecrf_ocio import Photo, Settings, calibrate
from facecrf_ocio.cli.choices import Choices
from facecrf_ocio.cli.facecrf import main
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.estimators import (
    ESTIMATOR_NAMES,
    ESTIMATORS,
    FALLBACKS,
    FIXED,
    FIXED_CURVES,
    JOINT,
    PUBLISHED,
    Estimator,
)
from facecrf_ocio.joint import JointModel, shipped_joint
from facecrf_ocio.published.answer import FittedCurve
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.values import Outcome, Verdict
from facecrf_ocio.wording.explanations import explanation

PAGE = (Path(__file__).parents[1] / "docs" / "how-it-works.md").read_text(encoding="utf-8")


def blank() -> Photo:
    return Photo(encoded=np.full((120, 100, 3), 0.5, np.float32))


# --- the rows ---


def test_names_are_told_apart():
    assert len(ESTIMATORS) == len(JOINT) + len(PUBLISHED) + len(FIXED)
    assert set(FALLBACKS) - {"none"} <= set(FIXED_CURVES)


@pytest.mark.parametrize("row", [*PUBLISHED, *FIXED], ids=lambda row: row.name)
def test_every_row_names_a_function_of_its_kind(row):
    taken = ["encoded", "model"] if row in FIXED else ["photo", "model", "settings"]
    assert list(inspect.signature(row.load()).parameters) == taken


@pytest.mark.parametrize("row", PUBLISHED, ids=lambda row: row.name)
def test_published_estimators_say_how_far_to_trust_them(row):
    assert row.reasons
    assert row.band_scale >= 1.0


def test_the_page_has_a_row_for_each_in_this_order():
    table = re.findall(r"^\| ((?:`[a-z0-9-]+`(?:, )?)+) \|", PAGE, re.MULTILINE)
    names = [name for cell in table for name in re.findall(r"`([a-z0-9-]+)`", cell)]
    first = names.index(ESTIMATOR_NAMES[0])
    assert tuple(names[first : first + len(ESTIMATOR_NAMES)]) == ESTIMATOR_NAMES


def test_the_help_says_what_each_looks_at():
    text = " ".join(CliRunner().invoke(main, ["calibrate", "--help"]).output.split())
    for row in ESTIMATORS.values():
        assert f"{row.name}: {row.does}" in text
        assert len(f"{row.name}: {row.does}") <= 46


def test_the_page_says_which_need_no_face():
    for row in PUBLISHED:
        line = next(line for line in PAGE.splitlines() if line.startswith(f"| `{row.name}`"))
        assert ("needs no face" in line) == (not row.needs_face)


# --- one more row ---


def steady_answer(photo, model, settings):
    """A published estimator that always answers the response model's mean."""
    return FittedCurve(np.tile(model.mean, (3, 1)), np.full((4, 3), 0.5), "4 pixels")


def test_one_row_adds_a_published_estimator(monkeypatch):
    toy = Estimator("steady", "nothing", "a toy", "unused", ("it is a toy",), band_scale=2.0)
    monkeypatch.setattr(Estimator, "load", lambda self: steady_answer)
    monkeypatch.setitem(ESTIMATORS, "steady", toy)
    found = calibrate(blank(), estimator="steady")
    assert found.outcome is Outcome.CALIBRATED
    assert found.confidence.reasons[-1] == "it is a toy"
    assert np.allclose(found.curve.linear[0, ::4095], [0.0, 1.0])
    assert re.search(r"^steady +a toy$", explanation("estimators"), re.MULTILINE)


# --- what calibrate takes for whom ---


@pytest.mark.parametrize(
    ("estimator", "model"),
    [("auto", dorf_model), ("joint", dorf_model), ("face", shipped_joint), ("mean", shipped_joint)],
)
def test_a_model_of_the_wrong_kind_is_refused(estimator, model):
    with pytest.raises(SettingsError, match=rf"{estimator}' takes a \w+Model, not a \w+Model"):
        calibrate(blank(), estimator=estimator, model=model())


def test_a_model_of_the_right_kind_is_used():
    dorf = dorf_model()
    brighter = replace(dorf, mean=dorf.mean**0.5)
    found = calibrate(blank(), estimator="mean", model=brighter)
    assert np.allclose(found.curve.linear[0], fixed_curve("mean", found.curve.encoded, brighter))
    wide = JointModel(shipped_joint().prior, shipped_joint().networks, 9.0)
    found = calibrate(blank(), estimator="joint", model=wide)
    usual = calibrate(blank(), estimator="joint")
    assert found.confidence.sigma[0, 2000] > 2.0 * usual.confidence.sigma[0, 2000]


@pytest.mark.parametrize("fallback", ["mean", "srgb"])
def test_joint_without_a_face_takes_the_fallback_that_was_asked_for(fallback):
    found = calibrate(blank(), estimator="joint", fallback=fallback)
    assert (found.outcome, found.estimator) == (Outcome.FALLBACK, fallback)
    assert found.confidence.verdict is Verdict.PRIOR_ONLY
    assert f"no face found: fell back to the {fallback} curve" in found.reason
    expected = fixed_curve(fallback, found.curve.encoded, dorf_model())
    assert np.allclose(found.curve.linear, expected, atol=1e-6)


def test_joint_without_a_face_or_a_fallback_answers_the_prior_s_mean():
    found = calibrate(blank(), estimator="joint")
    assert (found.outcome, found.estimator) == (Outcome.FALLBACK, "joint")
    assert "the mean of the prior" in found.reason


# --- one curve or three ---


def chosen(estimator: str, per_channel: bool | None) -> Choices:
    given = {"estimator": estimator, "per_channel": per_channel, "max_error": None}
    return Choices(fallback="none", prior="auto", min_confidence="weak", overwrite=False, **given)


@pytest.mark.parametrize("estimator", ["auto", "joint"])
def test_asking_joint_for_a_curve_per_channel_is_wrong_usage(estimator):
    with pytest.raises(click.UsageError, match="gives one curve for all channels"):
        chosen(estimator, per_channel=True)
    for given in (None, False):
        chosen(estimator, given)
    result = CliRunner().invoke(main, ["calibrate", "a.jpg", "-o", "b", "--per-channel"])
    assert result.exit_code == 2
    assert "leave it out, or choose another --estimator" in " ".join(result.output.split())


def test_the_others_give_what_is_asked_for():
    assert chosen("face", None).settings == chosen("face", per_channel=True).settings == Settings()
    assert chosen("face", per_channel=False).settings.shared_curve
