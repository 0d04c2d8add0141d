"""The paper's figures: what is computed for them, and that each comes out as a picture."""

from __future__ import annotations

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from facecrf_ocio import calibrate
from facecrf_ocio.benchmark.energy_profiles import (
    Profile,
    compare,
    gamma_profile,
    highlight_profile,
)
from facecrf_ocio.benchmark.paper_figures import (
    DOTS_PER_INCH,
    PAGE_WIDTH,
    curves_figure,
    png,
    profile_figure,
)
from facecrf_ocio.cli.bench_command import bench
from facecrf_ocio.plots.calibration_plot import curves_only
from facecrf_ocio.plots.seen import UNSEEN, seen_codes
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Confidence, Estimate, InverseCRF, Outcome, Photo, Verdict

SETTINGS = Settings()


@pytest.fixture(scope="module")
def profile():
    return gamma_profile(dorf_model(), SETTINGS, count=4)


def test_exact_pigment_energy_does_not_see_a_common_exponent(profile):
    """log g = gamma log I scales the matrices of eq. 16, whose ratio of singular values stays."""
    spread = np.ptp(profile.pigment, axis=0) / profile.pigment.max(axis=0)
    assert np.nanmax(spread) < 0.03


def test_the_right_candidates_are_those_of_the_photos(profile):
    assert np.array_equal(profile.truth, profile.photos)
    assert profile.candidates[[0, -1]].tolist() == [0.3, 1.0]


def test_highlights_run_from_none_to_all():
    profile = highlight_profile(dorf_model(), SETTINGS, count=2)
    assert profile.photos.tolist() == [0.0, 1.0]
    assert (profile.truth == 2.2).all()
    assert profile.pigment.shape == (21, 2)


def test_minimum_is_drawn_where_it_is():
    energy = np.array([[3.0, 1.0], [1.0, 2.0], [2.0, 3.0]])
    profile = Profile(np.arange(2.0), np.arange(3.0), np.zeros(2), energy, energy, energy)
    axes = profile_figure(profile, "photo", "candidate").axes[0]
    minimum = next(line for line in axes.lines if line.get_label() == "minimum")
    assert minimum.get_ydata().tolist() == [1.0, 0.0]


def test_every_estimate_and_the_truth_have_a_curve():
    photo = Photo(np.random.default_rng(0).random((20, 20, 3), np.float32))
    truth = np.tile(np.linspace(0, 1, 9) ** 2, (3, 1))
    compared = compare("noise", photo, truth, ("face", "mean", "srgb", "joint"), SETTINGS)
    refused = [estimate.estimator for estimate in compared.estimates if estimate.found is None]
    assert refused == ["face"]
    figure = curves_figure((compared, replace(compared, name="again")))
    drawn = [
        line.get_label() for line in figure.axes[1].lines if np.isfinite(line.get_ydata()).any()
    ]
    assert [name for name in drawn if not name.startswith("_")] == [
        "truth",
        "mean",
        "srgb",
        "joint",
    ]
    width = Image.open(BytesIO(png(figure))).size[0] / DOTS_PER_INCH
    assert width == pytest.approx(PAGE_WIDTH, abs=0.01)  # inches: it fits a page unscaled


def test_a_curve_is_dashed_where_the_photo_says_nothing_of_it():
    encoded = np.linspace(0.0, 1.0, 257)
    linear = np.stack([encoded**2.2, encoded**2.0, encoded**1.8])
    coverage = np.tile((encoded > 0.5).astype(float), (3, 1))
    told = Confidence(np.zeros_like(linear), coverage, Verdict.WEAK, ())
    found = InverseCRF(encoded, linear)
    estimate = Estimate(Outcome.CALIBRATED, "edge", "", found=found, confidence=told)
    axes = curves_only(estimate).axes[0]
    solid = next(line for line in axes.lines if line.get_label() == "R")
    dashed = next(line for line in axes.lines if line.get_label() == "_unseen")
    assert np.isnan(solid.get_ydata()[encoded < 0.48]).all()
    assert np.isfinite(solid.get_ydata()[encoded > 0.5]).all()
    assert np.isfinite(dashed.get_ydata()[encoded < 0.48]).all()
    assert UNSEEN in [text.get_text() for text in axes.get_legend().get_texts()]


def test_a_fixed_curve_is_not_dashed_since_it_is_nobody_s_guess():
    estimate = calibrate(Photo(np.zeros((8, 8, 3), np.float32)), estimator="srgb")
    assert seen_codes(estimate, 0).all()


@pytest.mark.slow
def test_command_draws_the_figures_that_need_no_data(tmp_path):
    result = CliRunner().invoke(bench, ["figures", "-o", str(tmp_path)])
    assert result.exit_code == 0, result.output
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"fig2_gamma.png", "fig3_highlights.png", "fig4_skin.png"}
