"""The response model: what the database says, what Columbia says, and what every curve obeys."""

from __future__ import annotations

import re

import numpy as np
import pytest
import scipy.io
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.response import fit_model
from facecrf_ocio.response.dorf import GRID_SIZE, read_dorf_inverse
from facecrf_ocio.response.model import (
    CURVE_SIZE,
    MIN_INCREMENT,
    dorf_model,
    load_model,
    strictly_increasing,
)

ARRAYS = ("grid", "mean", "basis")


@pytest.fixture(scope="module")
def dorf(development_data):
    return read_dorf_inverse(development_data / "crf" / "dorf_201_curves.mat")


@pytest.fixture(scope="module")
def emor(development_data):
    """Columbia's mean and 25 eigenvectors of inverse responses, each (1024,)."""
    text = (development_data / "crf" / "invemor.txt").read_text()
    parts = re.split(r"\s*(B|g0|hinv\(\d+\))\s*=\s*", text)[1:]
    table = {
        name: np.array(values.split(), float)
        for name, values in zip(parts[::2], parts[1::2], strict=True)
    }
    return table["g0"], np.array([table[f"hinv({n})"] for n in range(1, 26)])


def errors(found, true):
    """RMSE x 100 on a uniform grid of encoded values: min, median, mean, max, std."""
    e = 100.0 * np.sqrt(((found - true) ** 2).mean(axis=1))
    return e.min(), np.median(e), e.mean(), e.max(), e.std()


def test_there_are_201_curves_that_rise_from_0_to_1(dorf):
    assert dorf.shape == (201, GRID_SIZE)
    assert (np.diff(dorf, axis=1) >= 0).all()
    assert np.allclose(dorf[:, 0], 0.0)
    assert np.allclose(dorf[:, -1], 1.0)


def test_the_shipped_model_is_the_fit_script_s(development_data, tmp_path):
    source = str(development_data / "crf" / "dorf_201_curves.mat")
    assert fit_model.main([source, str(tmp_path / "model.npz")]) == 0
    made, shipped = load_model(tmp_path / "model.npz"), dorf_model()
    for name in ARRAYS:
        assert np.abs(getattr(made, name) - getattr(shipped, name)).max() < 1e-6
    for name in ("means", "covariances"):
        ours, theirs = (getattr(m.mixture, name) for m in (made, shipped))
        assert np.abs(ours - theirs).max() < 1e-6 * np.abs(theirs).max()


def test_the_fit_script_tells_its_usage(capsys):
    assert fit_model.main([]) == 2
    assert "dorf.mat model.npz" in capsys.readouterr().err


def srgb(encoded):
    """IEC 61966-2-1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


@pytest.mark.parametrize(
    ("answer", "published"),
    [
        (lambda e: e, (0.00, 22.3, 21.8, 44.6, 7.9)),
        (srgb, (1.10, 8.76, 9.92, 41.4, 7.3)),
        (lambda e: dorf_model().mean, (2.21, 7.10, 8.99, 39.8, 6.7)),
    ],
    ids=["identity", "sRGB", "g0"],
)
def test_blind_answers_err_as_published(dorf, answer, published):
    found = errors(answer(np.linspace(0.0, 1.0, GRID_SIZE)), dorf)
    assert found == pytest.approx(published, abs=0.052, rel=0.004)


def test_five_components_err_as_published(dorf):
    model = dorf_model()
    found = errors(model.samples(model.coefficients(dorf)), dorf)
    assert found == pytest.approx((0.03, 0.15, 0.20, 1.29, 0.18), abs=0.006)


def test_the_mean_is_columbia_s(emor):
    assert np.abs(dorf_model().mean - emor[0]).max() < 0.01


def test_the_subspace_is_columbia_s(emor):
    """Cosines of the principal angles between their five vectors and ours."""
    theirs = np.linalg.qr(emor[1][:5].T)[0]
    cosines = np.linalg.svd(dorf_model().basis @ theirs, compute_uv=False)
    assert (cosines[:4] > 0.999).all()
    assert cosines[4] > 0.97


def test_the_basis_is_orthonormal_vanishes_at_the_ends_and_has_fixed_signs():
    model = dorf_model()
    assert np.allclose(model.basis @ model.basis.T, np.eye(5), atol=1e-12)
    assert np.abs(model.basis[:, [0, -1]]).max() < 1e-12
    assert (model.basis.sum(axis=1) > 0).all()
    assert (model.mean[0], model.mean[-1]) == (0.0, 1.0)


def test_the_components_carry_falling_shares_of_the_variance(dorf):
    variances = dorf_model().coefficients(dorf).var(axis=0)
    assert (np.diff(variances) < 0).all()
    assert variances.sum() > 0.99 * dorf.var(axis=0).sum()


coefficients = arrays(float, (3, 5), elements=st.floats(-5.0, 5.0))


@given(coefficients)
def test_coefficients_and_samples_are_each_other_s_inverse(c):
    model = dorf_model()
    assert np.allclose(model.coefficients(model.samples(c)), c, atol=1e-10)


@given(coefficients)
def test_any_coefficients_give_a_valid_curve(c):
    model = dorf_model()
    curve = model.inverse_crf(model.samples(c))  # refuses what does not rise from 0 to 1
    assert curve.linear.shape == (3, CURVE_SIZE)


def test_a_valid_curve_is_kept(dorf):
    model = dorf_model()
    rising = dorf[(np.diff(dorf, axis=1) > MIN_INCREMENT).all(axis=1)][:3]
    curve = model.inverse_crf(rising)
    assert len(rising) == 3
    expected = [np.interp(curve.encoded, model.grid, row) for row in rising]
    assert np.abs(curve.linear - expected).max() < 1e-12


@given(arrays(float, st.tuples(st.just(3), st.integers(2, 300)), elements=st.floats(-2.0, 2.0)))
def test_strictly_increasing_makes_any_samples_rise_from_0_to_1(samples):
    curve = strictly_increasing(samples)
    assert curve.shape == samples.shape
    assert (curve[:, 0] == 0.0).all()
    assert (curve[:, -1] == 1.0).all()
    assert (np.diff(curve, axis=1) > 0).all()


@given(
    arrays(float, st.tuples(st.just(2), st.integers(2, 100)), elements=st.floats(1e-3, 1.0)),
    st.floats(-3.0, 3.0),
    st.floats(0.1, 10.0),
)
def test_strictly_increasing_only_shifts_and_scales_what_rises(increments, shift, scale):
    curve = np.pad(np.cumsum(increments, axis=1), ((0, 0), (1, 0)))
    expected = curve / curve[:, -1:]
    assert np.allclose(strictly_increasing(shift + scale * curve), expected, atol=1e-9)


def test_saving_and_loading_keeps_the_model_to_single_precision(tmp_path):
    model = dorf_model()
    model.save(tmp_path / "m.npz")
    again = load_model(tmp_path / "m.npz")
    for name in ARRAYS:
        assert np.abs(getattr(again, name) - getattr(model, name)).max() < 1e-7
    assert np.array_equal(again.mixture.means, model.mixture.means)


def test_the_model_cannot_be_changed_by_accident():
    model = dorf_model()
    for array in (model.mean, model.basis, model.mixture.means, model.mixture.covariances):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0


def test_what_is_not_a_dorf_file_is_named(tmp_path):
    text = tmp_path / "no.mat"
    text.write_text("not a matrix")
    other = tmp_path / "other.mat"
    scipy.io.savemat(other, {"x": 1.0})
    for path in (text, other, tmp_path / "missing.mat"):
        with pytest.raises(PhotoError, match=f"{path.name}: is not a DoRF file"):
            read_dorf_inverse(path)
