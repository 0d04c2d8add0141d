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
from facecrf_ocio.record.measured import MEASURED
from facecrf_ocio.values import InStops
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
