"""The paper's figures: what is computed for them, and that each comes out as a picture."""

from __future__ import annotations

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from facecrf_ocio.benchmark.energy_profiles import (
    Profile,
    compare,
    gamma_profile,
    highlight_profile,
)
from facecrf_ocio.benchmark.paper_figures import curves_figure, png, profile_figure
from facecrf_ocio.cli.bench_command import bench
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Photo

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
    compared = compare("noise", photo, truth, ("face", "mean", "srgb"), dorf_model(), SETTINGS)
    assert [estimate.found is None for estimate in compared.estimates] == [True, False, False]
    figure = curves_figure((compared, replace(compared, name="again")))
    drawn = [line.get_label() for line in figure.axes[1].lines if len(line.get_xdata())]
    assert drawn == ["mean", "srgb", "truth"]
    assert Image.open(BytesIO(png(figure))).size[0] > 1000


@pytest.mark.slow
def test_command_draws_the_figures_that_need_no_data(tmp_path):
    result = CliRunner().invoke(bench, ["figures", "-o", str(tmp_path)])
    assert result.exit_code == 0, result.output
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"fig2_gamma.png", "fig3_highlights.png", "fig4_skin.png"}
