"""An estimate draws itself, and shows itself in a notebook."""

from __future__ import annotations

import base64
import re
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

import facecrf_ocio
from facecrf_ocio import NotCalibratedError, Photo, calibrate


@pytest.fixture(scope="module")
def photo():
    return Photo(np.random.default_rng(0).random((32, 32, 3), np.float32))


@pytest.fixture(scope="module")
def mean(photo):
    return calibrate(photo, estimator="mean")


def test_the_band_drawn_is_the_one_of_the_report(mean):
    curves, stops = mean.plot().axes
    assert curves.get_xlabel() == "encoded value (1: white)"
    assert stops.get_ylabel() == "stops above sRGB"
    half = 1.645 * mean.confidence.sigma[0]
    top = np.clip(mean.curve.linear[0] + half, 0, 1)
    drawn = curves.collections[0].get_paths()[0].vertices
    middle = mean.curve.encoded[mean.curve.encoded.size // 2]
    at = drawn[np.isclose(drawn[:, 0], middle), 1].max()
    assert at == pytest.approx(np.interp(middle, mean.curve.encoded, top), abs=1e-3)


def test_it_shows_what_to_expect_and_its_picture(mean):
    shown = mean._repr_html_()
    assert "fallback (prior only)</b>" in shown
    assert "--" not in shown.split("<img")[0]
    picture = re.search(r"base64,([^\"]+)", shown)[1]
    with Image.open(BytesIO(base64.b64decode(picture))) as image:
        assert image.size[0] > 300


def test_its_summary_is_one_line_in_words_of_python(photo, mean):
    nothing = calibrate(photo)
    for estimate in (mean, nothing):
        assert "\n" not in estimate.summary
        assert "--" not in estimate.summary
    assert mean.summary.endswith("calibrate_pair with a raw file, or calibrate_bracket")
    assert "no face found" in nothing.summary
    assert 'fallback="mean"' in nothing.summary


def test_functions_that_a_summary_names_can_be_imported(mean):
    named = re.findall(r"calibrate_\w+", mean.summary)
    assert named == ["calibrate_together", "calibrate_pair", "calibrate_bracket"]
    assert all(callable(getattr(facecrf_ocio, name)) for name in named)


def test_without_a_curve_it_says_why_and_draws_nothing(photo):
    nothing = calibrate(photo)
    shown = replace(nothing, reason="<b>no</b> face")._repr_html_()
    assert "&lt;b&gt;no&lt;/b&gt; face" in shown
    assert "<img" not in shown
    with pytest.raises(NotCalibratedError):
        nothing.plot()
