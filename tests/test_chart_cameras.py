"""Cameras measured by charts: how they are, what the prior makes of them, who is held out."""

from __future__ import annotations

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from facecrf_ocio.benchmark.chart_cameras import chart_cameras, with_chart_cameras
from facecrf_ocio.benchmark.joint_folds import joint_model
from facecrf_ocio.benchmark.peers.drawn_chart import lit_chart, shot
from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.chart.find_chart import can_find
from facecrf_ocio.joint import shipped_joint
from facecrf_ocio.joint.prior import FAMILIES, from_triangles, triangles
from facecrf_ocio.response.stops import stops_error, uniform
from facecrf_ocio.synthetic import gamma_curve
from facecrf_ocio.training.__main__ import main

CAMERA = FAMILIES.index("camera")
pytestmark = pytest.mark.usefixtures("chart_curves")


def test_the_shipped_prior_has_their_component():
    shipped = shipped_joint().prior
    anew = with_chart_cameras(shipped)
    for name in ("weights", "means", "covariances", "family"):
        assert np.allclose(getattr(anew, name), getattr(shipped, name), atol=1e-6)


def test_families_stay_as_likely_as_each_other_and_the_component_is_half_of_cameras():
    prior = with_chart_cameras(shipped_joint().prior)
    shares = [prior.weights[prior.family == number].sum() for number in range(len(FAMILIES))]
    assert shares == pytest.approx([1 / 3] * 3)
    assert prior.weights[-1] == pytest.approx(1 / 6)
    assert prior.family[-1] == CAMERA


def test_it_is_narrower_than_what_it_stands_beside():
    """In brightness and contrast, which real cameras have in common."""
    prior = shipped_joint().prior
    spread = np.sqrt(np.diagonal(prior.covariances, axis1=1, axis2=2))[:, :2]
    others = spread[:-1][prior.family[:-1] == CAMERA]
    assert (spread[-1] < np.median(others, axis=0)).all()


def test_a_maker_is_held_out_however_its_name_is_written():
    prior, measured = shipped_joint().prior, chart_cameras()
    kinds = zip(measured.families, range(len(measured.names)), strict=True)
    makers = {maker for maker, row in kinds if measured.kind(row) == "camera_jpeg"}
    assert len(makers) > 6
    for maker in makers:
        without = with_chart_cameras(prior, [maker])
        assert not np.allclose(without.means[-1], prior.means[-1], atol=1e-4)
        again = with_chart_cameras(prior, [f"{maker.upper()} CORPORATION"])
        assert np.array_equal(without.means, again.means)
    assert np.allclose(with_chart_cameras(prior, ["Nobody"]).means, prior.means, atol=1e-6)


@pytest.mark.usefixtures("held_out_weights")
def test_the_bench_judges_them_by_weights_without_their_makers(chart_curves):
    responses = read_responses(chart_curves)
    for fold in range(5):
        model = joint_model(responses, fold)
        assert not np.allclose(model.prior.means[-1], shipped_joint().prior.means[-1], atol=1e-4)


@pytest.mark.skipif(not can_find(), reason="the installed OpenCV has no mcc")
def test_folders_of_photos_give_curves_of_cameras(tmp_path):
    curves = {"Acme/One": (2.2, 2.2), "Acme/Two": (1.7, 2.4), "Bcme/Three": (2.6, 2.6)}
    for folder, exponents in curves.items():
        place = tmp_path / "photos" / folder / "DCIM"
        place.mkdir(parents=True)
        for number, exponent in enumerate(exponents):
            light, _ = lit_chart(number, white=0.75)
            content, _ = shot(light, gamma_curve(exponent), quality=95)
            (place / f"{number}.JPG").write_bytes(content)
        Image.new("RGB", (300, 200), (90, 120, 30)).save(place / "other.jpg")
    output = tmp_path / "cameras.npz"
    arguments = ["charts", str(tmp_path / "photos"), "-o", str(output)]
    ended = CliRunner().invoke(main, [*arguments, "--without", "Bcme/Three"])
    assert ended.exit_code == 0, ended.output
    found = read_responses(output)
    # The photos of Acme Two do not agree, and Bcme Three was to be passed over.
    assert found.names == ("Acme One",)
    assert stops_error(found.inverse[0], uniform(gamma_curve(2.2))).mid < 0.05


def test_symmetric_matrices_come_back_from_the_half_that_is_stored():
    covariances = shipped_joint().prior.covariances
    halves = triangles(covariances)
    assert halves.shape == (len(covariances), 78)
    assert np.array_equal(from_triangles(halves, 12), covariances)
