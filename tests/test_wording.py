"""What results say: from fields, alike on every surface, and with flags only where there are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from facecrf_ocio import Confidence, Estimate, InverseCRF, NotCalibratedError, Outcome, Verdict
from facecrf_ocio.cli.explain_command import TOPIC_NAMES
from facecrf_ocio.cli.facecrf import main
from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.errors import SettingsError, in_options
from facecrf_ocio.face.second_look import NOBODYS
from facecrf_ocio.photo.tags.edits import edits_told, made_as_told
from facecrf_ocio.record.demand import Demand, demand
from facecrf_ocio.record.measured import MEASURED
from facecrf_ocio.values import Camera, InStops
from facecrf_ocio.wording.doubts import (
    bent_by,
    contradicted,
    lifted_by,
    not_single,
    of_several_cameras,
)
from facecrf_ocio.wording.expectation import expectation
from facecrf_ocio.wording.explanations import TOPICS, explanation
from facecrf_ocio.wording.next_steps import next_steps
from facecrf_ocio.wording.sentence import ANYWHERE, COMMAND_LINE, PYTHON, remedy, sentence

CODES = np.linspace(0.0, 1.0, 1024)


def estimate(curve, *, verdict=Verdict.RELIABLE, sigma=0.02, mid=0.1, shadows=0.4, known=True):
    shape = (3, CODES.size)
    stops = InStops(np.full((3, 256), mid), mid, shadows) if known else None
    confidence = Confidence(np.full(shape, sigma), np.ones(shape), verdict, (), stops)
    found = InverseCRF(CODES, np.tile(curve, (3, 1)))
    return Estimate(Outcome.CALIBRATED, "joint", "4 cues", found=found, confidence=confidence)


NOTHING = Estimate(Outcome.NOT_CALIBRATED, "joint", "no face found", "use a photo with a face")
SRGB, POWER = decode_srgb(CODES), CODES**3.5


def test_a_line_tells_the_error_and_what_srgb_would_do():
    assert sentence(estimate(SRGB)) == (
        "expect 0.1 stops off in the midtones, 0.4 in the shadows (2 % of white); "
        "sRGB would do as well"
    )


def test_srgb_is_measured_against_the_curve_and_the_curve_s_own_error():
    expected = expectation(estimate(POWER, mid=0.3))
    codes = np.arange(64, 236) / 255
    away = np.log2(decode_srgb(codes) / decode_srgb(128 / 255)) - 3.5 * np.log2(codes * 255 / 128)
    assert expected.srgb_stops == pytest.approx(np.hypot(np.abs(away).mean(), 0.3), rel=1e-3)
    assert not expected.srgb_does_as_well
    assert "sRGB would be" in sentence(estimate(POWER, mid=0.3))


def test_small_errors_get_a_second_digit_and_tiny_ones_a_bound():
    said = sentence(estimate(SRGB, sigma=0.004, mid=0.042))
    assert "0.04 stops" in said
    assert "less than 1 % of white" in said


def test_stops_that_are_not_known_are_not_made_up():
    said = sentence(estimate(SRGB, known=False))
    assert said.startswith("expect errors about 2 % of white")


@pytest.mark.parametrize("surface", [ANYWHERE, COMMAND_LINE, PYTHON])
def test_what_is_weak_says_what_makes_it_surer(surface):
    said = sentence(estimate(POWER, verdict=Verdict.WEAK), surface)
    assert surface.together in said
    assert surface.pair in said
    assert surface.together not in sentence(estimate(POWER), surface)


def doubting(*doubts, estimator="joint"):
    told = estimate(POWER, verdict=Verdict.WEAK)
    confidence = replace(told.confidence, doubts=doubts)
    return replace(told, estimator=estimator, confidence=confidence)


BENT = bent_by(["Active D-Lighting (Auto)"])[0]
EDITED = not_single(edits_told("", "Adobe Photoshop 25.0"))[0]
HDR = not_single(made_as_told(b"", Camera("Apple", "iPhone 12"), 3))[0]
OTHER_STYLE = contradicted(1, "the measured response of Acme One")
MIXED = of_several_cameras(2, "Acme One, Acme Two")
OFF, RAW = "photos with that setting off", COMMAND_LINE.raw


@pytest.mark.parametrize(
    ("doubt", "ways"),
    [
        (BENT, (OFF, RAW)),
        (HDR, (OFF, RAW)),
        (EDITED, ("the picture as the camera wrote it", RAW)),
        (not_single(["channels seem swapped"])[0], ("the picture as the camera wrote it", RAW)),
        (not_single(["its gain map strays from every single curve by 0.3 stops"])[0], (RAW,)),
        (not_single(edits_told("", "Midjourney"))[0], ("the picture as the camera wrote it",)),
        (not_single([NOBODYS])[0], ("a photo of a person", RAW)),
        (not_single(["a.jpg: " + NOBODYS])[0], ("a photo of a person", RAW)),
        (OTHER_STYLE, (RAW,)),
        (MIXED, ("photos of one camera alone",)),
        ("the face is dark: 80 % of it below code 64", (COMMAND_LINE.together, COMMAND_LINE.pair)),
    ],
)
def test_of_a_doubt_only_what_lifts_it_is_told(doubt, ways):
    """More photos of the camera, `--together`, make a band narrower, and lift few doubts."""
    told = doubting(doubt)
    assert sentence(told, COMMAND_LINE).endswith(f"{doubt}; surer: {', or '.join(ways)}")
    steps = next_steps(told, COMMAND_LINE)
    assert f"Make it surer: {ways[0]}." in steps
    assert len([one for one in steps if "measure the camera" in one]) == len(ways) - 1


def test_of_several_doubts_what_lifts_all_is_told():
    dark = "the face is dark: 80 % of it below code 64"
    assert sentence(doubting(dark, BENT)).endswith(f"surer: {OFF}, or {ANYWHERE.raw}")
    assert sentence(doubting(EDITED, BENT)).endswith(f"surer: {ANYWHERE.raw}")
    assert sentence(doubting(MIXED, EDITED)).endswith(
        "surer: photos of one camera alone and the picture as the camera wrote it"
    )
    assert len(lifted_by([BENT, BENT])) == len(lifted_by([BENT]))


def test_a_chart_whose_curve_was_bent_is_not_mended_by_its_light():
    said = sentence(doubting(BENT, estimator="chart"), COMMAND_LINE)
    assert said.endswith(f"{BENT}; surer: {OFF}")
    other = "a photo's exposure is false: leave it out"
    assert sentence(doubting(other, estimator="bracket"), COMMAND_LINE).endswith(other)


def test_what_is_asked_for_in_vain_is_mended_by_what_lifts_the_doubts():
    least = Demand("reliable")
    weak = estimate(POWER, verdict=Verdict.WEAK)
    assert "several photos together" in demand(weak, least).remedy
    told = demand(doubting(BENT), least).remedy
    assert told == f"use {OFF}, {ANYWHERE.raw}, or ask for less"


@pytest.mark.parametrize("estimator", MEASURED)
def test_a_measurement_is_made_surer_by_measuring_better(estimator):
    """And not by photos of the camera, nor by a pair as if there were none."""
    weak = replace(estimate(POWER, verdict=Verdict.WEAK), estimator=estimator)
    said = " ".join([sentence(weak, COMMAND_LINE), *next_steps(weak, COMMAND_LINE)])
    assert COMMAND_LINE.together not in said
    assert COMMAND_LINE.pair not in said
    assert estimator in said


def test_flags_are_told_on_the_command_line_alone():
    for each in (NOTHING, estimate(POWER, verdict=Verdict.WEAK)):
        assert "--" in sentence(each, COMMAND_LINE)
        assert "--" not in sentence(each, PYTHON) + sentence(each)
    with pytest.raises(NotCalibratedError, match='fallback="mean"') as caught:
        _ = NOTHING.curve
    assert "--" not in str(caught.value)


def test_a_photo_that_gives_nothing_has_a_remedy_that_its_surface_offers():
    lacking = Estimate(Outcome.NOT_CALIBRATED, "rank", "no edges were found", "use a sharp photo")
    assert remedy(lacking) == "use a sharp photo, or the mean response instead"
    assert remedy(lacking, PYTHON) == 'use a sharp photo, or fallback="mean"'
    assert remedy(lacking, COMMAND_LINE) == "use a sharp photo, or --fallback mean"
    for estimator in MEASURED:
        measured = replace(lacking, estimator=estimator)
        assert remedy(measured, COMMAND_LINE) == remedy(measured, PYTHON) == "use a sharp photo"


def test_linear_files_need_nothing():
    linear = Estimate(Outcome.ALREADY_LINEAR, "none", "the file is scene-linear already")
    assert sentence(linear) == "linear already: use the pixels as they are"


@pytest.mark.parametrize("topic", TOPICS)
def test_every_topic_is_explained_in_lines_that_fit_a_terminal(topic):
    result = CliRunner().invoke(main, ["explain", topic])
    assert result.output == explanation(topic)
    assert max(map(len, result.output.splitlines())) <= 80


@pytest.mark.parametrize("topic", TOPICS)
@pytest.mark.parametrize("width", [30, 60])
def test_explanations_keep_their_words_where_a_terminal_is_narrow(topic, width):
    narrow = explanation(topic, width)
    assert max(map(len, narrow.splitlines())) <= width
    assert narrow.split() == explanation(topic).split()


def test_every_verdict_and_outcome_is_explained():
    assert TOPIC_NAMES == TOPICS
    assert [v.value for v in Verdict if f"\n{v.value}" not in explanation("verdicts")] == []
    assert [o.value for o in Outcome if f"\n{o.value}" not in explanation("outcomes")] == []


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('a.clf: encodes; pass direction="encode"', "a.clf: encodes; pass --direction encode"),
        ("a.jpg: no chart; give corners_xy=...", "a.jpg: no chart; give --corners"),
        (
            'a.ocio: has one; leave out space="lin_p3d65"',
            "a.ocio: has one; leave out --to lin_p3d65",
        ),
        ("tls://a: is silent; speak TLS (ca=...)", "tls://a: is silent; speak TLS (--tls-ca)"),
        ("a=True.jpg: is empty; copy it again", "a=True.jpg: is empty; copy it again"),
        (
            "a.jpg: took long; raise seconds=... and pass retry=True",
            "a.jpg: took long; raise --timeout and pass --retry",
        ),
    ],
)
def test_what_python_calls_an_argument_is_an_option_on_the_command_line(text, told):
    assert SettingsError(text).on_command_line() == told


def test_where_a_command_lacks_the_option_the_one_that_has_it_is_named():
    assert in_options("leave it out with exclude=...", "facecrf batch") == (
        "leave it out with --exclude (of `facecrf batch`)"
    )
    assert in_options("copy it again", "facecrf batch") == "copy it again"
