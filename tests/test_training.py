"""Training: photos of a head through drawn responses, and what a held-out fold must not see."""

from __future__ import annotations

import numpy as np
import pytest
from photo_files import write

from facecrf_ocio.joint import load_joint
from facecrf_ocio.joint.messages import COMBINED
from facecrf_ocio.joint.statistics import CUES
from facecrf_ocio.synthetic import SyntheticSpec, render_face
from facecrf_ocio.training.__main__ import _kept
from facecrf_ocio.training.curves import NO_ROW, CurveSource, fold_of_rows, rows_outside
from facecrf_ocio.training.simulate import Example, simulate
from facecrf_ocio.training.variation import _demosaic, _even, process, vary

GRID = np.linspace(0.0, 1.0, 1024)


@pytest.fixture(scope="module")
def source():
    film = np.array([GRID**e for e in np.linspace(0.6, 3.0, 40)])
    digital = np.array([GRID**e for e in np.linspace(1.8, 2.6, 16)])
    kinds = ("camera_jpeg", "webcam", "phone_isp", "raw_converter") * 4
    return CurveSource(film, digital, kinds, ("A", "B") * 8)


@pytest.fixture(scope="module")
def head(tmp_path_factory):
    path = tmp_path_factory.mktemp("head") / "head.exr"
    write(path, render_face(SyntheticSpec(seed=3)).linear, "float")
    return path


@pytest.fixture(scope="module")
def examples(head, source):
    return list(simulate(head, source, 9, seed=1))


def test_drawn_responses_are_responses(source):
    generator = np.random.default_rng(0)
    for number in range(200):
        drawn = source.draw(generator, measured=number % 2 == 0)
        assert drawn.inverse.shape == (1024,)
        assert (np.diff(drawn.inverse) >= 0.0).all()
        assert 0.0 <= drawn.inverse[0] <= drawn.inverse[-1] <= 1.0
        assert drawn.row == NO_ROW or 0 <= drawn.row < (40, 16)[drawn.family]


def test_a_measured_response_is_drawn_as_it_is(source):
    generator = np.random.default_rng(0)
    for _ in range(20):
        drawn = source.draw(generator, measured=True)
        known = (source.dorf, source.modern)[drawn.family][drawn.row]
        assert np.array_equal(drawn.inverse, known)


def test_every_photo_shows_the_cues(examples):
    assert len(examples) == 9
    assert all(set(example.by_cue) <= set(CUES) for example in examples)
    assert sum(set(example.by_cue) == set(CUES) for example in examples) >= 6
    assert all(np.isfinite(v).all() for example in examples for v in example.by_cue.values())


def test_the_same_seed_gives_the_same_photos(head, source, examples):
    again = next(iter(simulate(head, source, 1, seed=1)))
    assert np.array_equal(again.by_cue["grain"], examples[0].by_cue["grain"])


def test_software_leaves_8_bit_codes():
    generator = np.random.default_rng(0)
    encoded = np.rint(generator.random((32, 32, 3)) * 255).astype(np.float32) / np.float32(255)
    for _ in range(30):
        codes = process(encoded, generator) * 255.0
        assert np.allclose(codes, np.rint(codes), atol=1e-3)


def test_variation_keeps_light_in_its_range_():
    generator = np.random.default_rng(0)
    light = generator.random((40, 50, 3), np.float32)
    for _ in range(60):
        varied = vary(light, generator)
        assert varied.shape == light.shape
        assert varied.dtype == np.float32
        assert 0.0 <= varied.min() <= varied.max() <= 1.0


def test_a_mosaic_of_one_color_is_that_color_again():
    color = np.broadcast_to(np.float32([0.6, 0.4, 0.2]), (32, 32, 3))
    assert np.allclose(_demosaic(color), color, atol=1e-4)


def test_even_skin_keeps_its_shading_and_loses_color_contrast():
    generator = np.random.default_rng(0)
    light = generator.uniform(0.2, 0.8, (80, 90, 3)).astype(np.float32)
    even = _even(light, 0.3)
    assert np.allclose(even.mean(axis=2), light.mean(axis=2), rtol=2e-3)
    before, after = (p / p.mean(axis=2, keepdims=True) for p in (light, even))
    assert after.std() == pytest.approx(0.3 * before.std(), rel=0.05)


def test_a_demosaiced_photo_has_noise_that_its_neighbors_share():
    noisy = np.random.default_rng(0).normal(0.5, 0.05, (200, 200, 3)).astype(np.float32)
    full = _demosaic(np.clip(noisy, 0.0, 1.0))
    for channel in range(3):
        plane = full[..., channel] - full[..., channel].mean()
        assert (plane[:, 1:] * plane[:, :-1]).mean() > 0.2 * (plane**2).mean()


def test_a_held_out_fold_sees_none_of_its_rows(source):
    """A pure power is of no camera and always seen; neighbors to mix with share the fold."""
    nothing = np.zeros(1024, np.float32)
    rows = [Example("", 0, row, False, nothing, {}) for row in (NO_ROW, *range(40))]
    modern = [Example("", 1, row, False, nothing, {}) for row in range(16)]
    kept = _kept([*rows, *modern], fold=4, rows=40, without=(), modern=None)
    film = [e.row for e in kept if e.family == 0]
    assert film[0] == NO_ROW
    assert set(film[1:]) == set(np.flatnonzero(rows_outside(4, 40)))
    assert not set(film[1:]) & set(np.flatnonzero(fold_of_rows(40) == 4))
    assert len(kept) == len(film) + 16


def test_a_maker_can_be_held_out(tmp_path):
    np.savez(tmp_path / "modern.npz", maker=["A", "B", "A"])
    nothing = np.zeros(1024, np.float32)
    modern = [Example("", 1, row, False, nothing, {}) for row in range(3)]
    options = {"fold": None, "rows": 40, "modern": tmp_path / "modern.npz"}
    assert [e.row for e in _kept(modern, without=("A",), **options)] == [1]


def test_a_maker_held_out_is_in_no_mixture_either(tmp_path):
    np.savez(tmp_path / "modern.npz", maker=["A", "B", "A"])
    nothing = np.zeros(1024, np.float32)
    pairs = [(1, 0), (1, NO_ROW), (2, 1), (1, 1)]
    mixed = [Example("", 1, a, False, nothing, {}, mixed_with=b) for a, b in pairs]
    options = {"fold": None, "rows": 40, "modern": tmp_path / "modern.npz"}
    kept = _kept(mixed, without=("A",), **options)
    assert [(e.row, e.mixed_with) for e in kept] == [(1, NO_ROW), (1, 1)]


def test_strangers_are_mixed_and_named(source):
    generator = np.random.default_rng(5)
    drawn = [source.draw(generator, measured=False) for _ in range(600)]
    mixed = [d for d in drawn if d.family == 1 and d.mixed_with != NO_ROW]
    strangers = [d for d in mixed if source.maker[d.row] != source.maker[d.mixed_with]]
    assert 0.1 < len(strangers) / len(mixed) < 0.3
    assert all(d.row >= 0 for d in drawn if d.mixed_with != NO_ROW)


@pytest.mark.slow
def test_what_is_fitted_can_be_loaded_and_asked(head, source, tmp_path):
    fit = pytest.importorskip("facecrf_ocio.training.fit", reason="needs the extra train")
    examples = list(simulate(head, source, 300, seed=2))
    curves = np.array([e.inverse for e in examples], dtype=np.float64)
    prior, analysis = fit.fit_prior(curves, np.array([e.family for e in examples]))
    training = fit.Training(epochs=2, members=1)
    member = fit.fit_networks(examples, prior, analysis, training, seed=0)
    fit.save_joint(tmp_path / "model.npz", prior, [member], 1.0)
    model = load_joint(tmp_path / "model.npz")
    messages = model.networks.messages(examples[0].by_cue)
    assert set(messages) == {*examples[0].by_cue, COMBINED}
    assert all((message.precision > 0.0).all() for message in messages.values())
