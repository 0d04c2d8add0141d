"""Training: photos of a head through drawn responses, and what a held-out fold must not see."""

from __future__ import annotations

import json
from dataclasses import replace

import cv2
import numpy as np
import pytest
from click.testing import CliRunner
from face_photos import grace_hopper
from photo_files import write

from facecrf_ocio import Photo
from facecrf_ocio.benchmark.joint_folds import held_out_joint
from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.joint import conclude, gather, load_joint
from facecrf_ocio.joint.messages import COMBINED
from facecrf_ocio.joint.statistics import CUES
from facecrf_ocio.joint.whole_steps import exact_array
from facecrf_ocio.synthetic import SyntheticSpec, render_face
from facecrf_ocio.synthetic.jpeg import through_jpeg
from facecrf_ocio.training.__main__ import main
from facecrf_ocio.training.before_camera import dead_leaves, read_head, saturate, stage
from facecrf_ocio.training.curves import NO_ROW, CurveSource, fold_of_rows, rows_outside
from facecrf_ocio.training.denoise import Denoiser
from facecrf_ocio.training.draw_process import HARDLY_PROCESSED, draw_process
from facecrf_ocio.training.layout import draw_layout, some_windows
from facecrf_ocio.training.parts import Examples, read_parts, write_part
from facecrf_ocio.training.plan import Data, held_out_names, left_out
from facecrf_ocio.training.process import Response, demosaiced, photograph
from facecrf_ocio.training.simulate import simulate
from facecrf_ocio.training.weights import pack, with_band

GRID = np.linspace(0.0, 1.0, 1024)
NOTHING = Denoiser("none", 0.0, 1.0, 0.0)
KINDS = ("camera_jpeg", "webcam", "phone_isp", "raw_converter") * 4


@pytest.fixture(scope="module")
def source():
    film = np.array([GRID**e for e in np.linspace(0.6, 3.0, 40)])
    digital = np.array([GRID**e for e in np.linspace(1.8, 2.6, 16)])
    return CurveSource(film, digital, KINDS, ("A", "B") * 8)


@pytest.fixture(scope="module")
def head(tmp_path_factory):
    path = tmp_path_factory.mktemp("head") / "head.exr"
    write(path, render_face(SyntheticSpec(seed=3)).linear, "float")
    return read_head(path, noisy=False)


@pytest.fixture(scope="module")
def around():
    return (dead_leaves(np.random.default_rng(0)),)


@pytest.fixture(scope="module")
def examples(head, around, source):
    return list(simulate([head], around, source, 6, [1]))


@pytest.fixture
def process():
    """Nothing but the response: no noise, no processing, no compression."""
    drawn = draw_process(np.random.default_rng(0))
    return replace(
        drawn, stops=0.0, gains=np.ones(3), blur=0.0, full_well=np.inf, read_noise=0.0, matrix=1.0,
        mosaic="none", denoise=NOTHING, smooth=NOTHING, sharpen=0.0, scale=1.0, jpeg=0,
        first_jpeg=0, sharpen_small=0.0,
    )  # fmt: skip


def untouched(process):
    """Whether nothing but light, noise and the response made the photo."""
    steps = (process.blur, process.sharpen, process.jpeg, process.first_jpeg)
    kept = {process.denoise.kind, process.smooth.kind, process.mosaic} == {"none"}
    return kept and not any(steps) and process.scale == 1.0


def test_some_photos_are_hardly_processed_and_all_are_exposed_alike():
    drawn = [draw_process(np.random.default_rng([7, n]), HARDLY_PROCESSED) for n in range(1000)]
    ordinary = [draw_process(np.random.default_rng([7, n])) for n in range(1000)]
    assert 150 < sum(map(untouched, drawn)) < 350
    assert sum(map(untouched, ordinary)) < 10
    assert [p.stops for p in drawn] == [p.stops for p in ordinary]


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


def test_nine_models_of_a_maker_are_drawn_as_often_as_three_of_others():
    makers = (*"A" * 9, *"BCD") * 4
    curves = np.array([GRID**e for e in np.linspace(1.8, 2.6, len(makers))])
    source = CurveSource(curves, curves, tuple(np.repeat(KINDS[:4], 12)), makers)
    generator = np.random.default_rng(0)
    drawn = [source.draw(generator, measured=True) for _ in range(3000)]
    of_a = [makers[d.row] == "A" for d in drawn if d.family == 1]
    assert np.mean(of_a) == pytest.approx(0.5, abs=0.05)


def test_strangers_are_mixed_and_named(source):
    generator = np.random.default_rng(5)
    drawn = [source.draw(generator, measured=False) for _ in range(600)]
    mixed = [d for d in drawn if d.family == 1 and d.mixed_with != NO_ROW]
    strangers = [d for d in mixed if source.maker[d.row] != source.maker[d.mixed_with]]
    assert 0.1 < len(strangers) / len(mixed) < 0.3
    assert all(d.row >= 0 for d in drawn if d.mixed_with != NO_ROW)


def test_most_exposures_are_usual_and_four_in_ten_anything_from_dark_to_bright():
    generator = np.random.default_rng(2)
    stops = np.array([draw_process(generator).stops for _ in range(4000)])
    assert (stops.min(), stops.max()) == (pytest.approx(-4.0, abs=0.05), 2.0)
    # Of the usual ones 3 in 1,000 are below -3, of the others a sixth.
    assert np.mean(stops < -3.0) == pytest.approx(0.6 * 0.003 + 0.4 / 6.0, abs=0.012)
    assert np.mean(np.abs(stops) < 1.1) == pytest.approx(0.6 * 0.683 + 0.4 * 2.2 / 6.0, abs=0.025)
    assert np.mean(np.abs(stops) < 1e-3) < 0.01


def test_without_noise_and_processing_a_photo_is_its_response(process):
    light = np.random.default_rng(1).uniform(0.0, 1.0, (40, 50, 3)).astype(np.float32)
    response = Response.of(GRID**2.2)
    encoded = photograph(light, process, response, (40, 50), np.random.default_rng(0))
    assert np.abs(encoded - light ** (1.0 / 2.2)).max() < 1.0 / 255.0
    assert np.allclose(encoded * 255.0, np.rint(encoded * 255.0), atol=1e-3)


def test_noise_is_that_of_photons_at_the_size_of_the_sensor(process):
    noisy = replace(process, full_well=2000.0, raw_gains=np.ones(3))
    light = np.full((300, 300, 3), 0.25, np.float32)
    line = Response.of(GRID)
    generator = np.random.default_rng(0)
    fine = photograph(light, noisy, line, (300, 300), generator)
    assert fine.std() == pytest.approx(np.sqrt(0.25 / 2000.0), rel=0.03)
    coarse = photograph(light, noisy, line, (300, 300), generator, coarse=0.25)
    assert coarse.std() == pytest.approx(0.25 * fine.std(), rel=0.05)


def test_every_process_leaves_codes_of_the_size_that_is_stored():
    generator = np.random.default_rng(4)
    light = generator.random((96, 128, 3), np.float32)
    response = Response.of(GRID**2.2)
    for _ in range(30):
        encoded = photograph(light, draw_process(generator), response, (64, 80), generator)
        assert encoded.shape == (64, 80, 3)
        assert 0.0 <= encoded.min() <= encoded.max() <= 1.0


def test_a_mosaic_of_one_color_is_that_color_again():
    color = np.broadcast_to(np.float32([0.6, 0.4, 0.2]), (32, 32, 3))
    assert np.allclose(demosaiced(color, "edge-aware"), color, atol=1e-4)


@pytest.mark.parametrize("kind", ["bilateral", "shrink", "blur"])
def test_denoisers_take_noise_and_leave_an_edge(kind):
    generator = np.random.default_rng(0)
    step = np.where(np.arange(80) < 40, 0.3, 0.7)[None, :, None] * np.ones((80, 1, 3))
    noisy = (step + generator.normal(0.0, 0.01, step.shape)).astype(np.float32)
    strength = 0.8 if kind == "blur" else 3.0
    clean = Denoiser(kind, strength, 1.5, 0.0).apply(noisy, 0.01)
    assert clean[:, :30].std() < 0.7 * noisy[:, :30].std()
    assert clean[:, 50:].mean() - clean[:, :30].mean() == pytest.approx(0.4, abs=0.01)


def test_less_color_is_kept_where_color_is_sampled_coarsely():
    generator = np.random.default_rng(0)
    picture = generator.integers(51, 205, (64, 64, 3), np.uint8)
    errors = [
        np.abs(through_jpeg(picture, 95, sampling).astype(float) - picture).mean()
        for sampling in ("4:2:0", "4:2:2", "4:4:4")
    ]
    assert errors == sorted(errors, reverse=True)


def test_a_frame_holds_its_face_and_windows_stand_for_all(head, around):
    generator = np.random.default_rng(3)
    for _ in range(40):
        layout = draw_layout(head, around, generator)
        points = layout.face.landmarks_xyz[:, :2]
        assert layout.height * layout.width <= 25e6
        assert (points.min(axis=0) > -0.1 * np.ptp(points[:, 0])).all()
        assert 55.0 < np.ptp(points[:, 0]) < 2800.0
    windows = [(slice(0, 192), slice(0, 192)), (slice(0, 192), slice(512, 704))]
    parts, weight = some_windows(windows, 1, 128, generator)
    assert len(parts) == 1
    assert weight == pytest.approx(2 * 192**2 / 128**2)
    assert parts[0][0].start % 16 == 0


def test_a_staged_head_keeps_its_shape_and_grays_have_no_color(head):
    generator = np.random.default_rng(0)
    for _ in range(10):
        light = stage(head, generator)
        assert light.shape == head.linear.shape
        assert light.min() >= 0.0
    gray = saturate(head.linear, 0.0)
    assert np.allclose(gray, gray[..., :1], atol=1e-6)


def test_every_photo_shows_most_cues(examples):
    assert len(examples) >= 4
    assert all(set(example.of_face) <= set(CUES) for example in examples)
    assert all(np.isfinite(v).all() for e in examples for v in e.of_face.values())


def test_the_same_seed_gives_the_same_photos(head, around, source, examples):
    again = next(iter(simulate([head], around, source, 1, [1])))
    assert np.array_equal(again.photo.histograms, examples[0].photo.histograms)


def test_parts_come_back_from_disk_as_statistics(tmp_path, examples):
    write_part(tmp_path / "part.npz", examples)
    stored = read_parts([tmp_path / "part.npz"] * 2, KINDS)
    assert len(stored) == 2 * len(examples)
    assert set(stored.by_cue) == set(CUES)
    truth = np.array([e.drawn.inverse for e in examples])
    assert np.allclose(stored.inverse[: len(examples)], truth, atol=1e-6)
    assert not list(tmp_path.glob("*.tmp"))


def of_rows(family, row, mixed_with) -> Examples:
    count = len(row)
    return Examples(
        np.zeros((count, 1024), np.float32), np.full(count, family), np.array(row),
        np.array(mixed_with), np.full(count, family), {}, {}, np.array([""] * count),
    )  # fmt: skip


def test_a_held_out_fold_sees_none_of_its_rows():
    """A pure power is of no camera and always seen; neighbors to mix with share the fold."""
    rows = of_rows(0, [NO_ROW, *range(201)], [NO_ROW] * 202)
    without = left_out("dorf4", rows, Data(None))
    assert not without[0]
    seen = set(rows.row[~without]) - {NO_ROW}
    assert seen == set(np.flatnonzero(rows_outside(4, 201)))
    assert not seen & set(np.flatnonzero(fold_of_rows(201) == 4))
    assert not left_out("dorf4", of_rows(1, [180], [190]), Data(None)).any()


@pytest.mark.parametrize("file", ["modern", "stacks", "charts"])
def test_a_maker_held_out_is_in_no_mixture_and_in_no_file(development_data, chart_curves, file):
    source = Data(development_data, chart_curves)
    makers = np.array(source.curves().maker)
    numbers = range(len(makers))
    folds = [name for name in held_out_names() if name.startswith(file)]
    alone = [left_out(name, of_rows(1, numbers, [NO_ROW] * len(makers)), source) for name in folds]
    held_out = [set(makers[without]) for without in alone]
    assert all(held_out)
    assert sum(map(len, held_out)) == len(set().union(*held_out))  # none in two folds
    for name, without, gone in zip(folds, alone, held_out, strict=True):
        assert not gone & set(makers[~without])
        mixed = left_out(name, of_rows(1, [NO_ROW] * len(makers), numbers), source)
        assert (mixed == without).all()
    assert set().union(*held_out) == set(read_responses(source.digital[file]).families)


@pytest.mark.slow
@pytest.mark.usefixtures("chart_curves")
def test_what_is_fitted_can_be_loaded_and_asked(head, around, source, tmp_path):
    fit = pytest.importorskip("facecrf_ocio.training.fit", reason="needs the extra train")
    cv2.setNumThreads(1)
    write_part(tmp_path / "part.npz", list(simulate([head], around, source, 300, [2])))
    examples = read_parts([tmp_path / "part.npz"], KINDS)
    fit.fit_joint(tmp_path / "model.npz", examples, fit.Training(epochs=2, members=1), None, (), {})
    model = load_joint(tmp_path / "model.npz")
    by_cue = {c: v[0].astype(float) for c, v in examples.by_cue.items() if np.isfinite(v[0]).all()}
    messages = model.networks.messages(by_cue)
    assert set(messages) == {*by_cue, COMBINED}
    assert all((message.precision > 0.0).all() for message in messages.values())
    assert model.networks.stretch(by_cue) >= 1.0


def test_the_band_of_packed_weights_can_be_set(tmp_path):
    for name in ("a", "b"):
        arrays = {"band_scale": 1.0, "stops_scale": np.ones((3, 2)), "prior_mean": np.arange(3.0)}
        np.savez(tmp_path / f"{name}.npz", made_by="{}", **arrays)
    pack(tmp_path / "all.npz", {name: tmp_path / f"{name}.npz" for name in ("a", "b")})
    told = np.array([[0.904, 0.7], [0.8, 0.6], [1.0, 1.1]])
    with_band(tmp_path / "all.npz", 1.304, told, "by a test")
    with np.load(tmp_path / "all.npz") as stored:
        assert set(stored.files) == {
            f"{name}/{key}" for name in ("a", "b") for key in (*arrays, "made_by")
        }
        assert float(stored["b/band_scale"]) == 1.3
        assert stored["a/stops_scale"].tolist() == [[0.9, 0.7], [0.8, 0.6], [1.0, 1.1]]
        assert stored["b/prior_mean"].tolist() == [0.0, 1.0, 2.0]
        assert json.loads(str(stored["a/made_by"])) == {"band_measured": "by a test"}


def test_weights_are_stored_in_bytes_and_read_to_half_a_step(tmp_path):
    exact = np.random.default_rng(1).normal(size=(5, 30)) * 10.0 ** np.arange(-2, 3)[:, None]
    exact[3] = 0.0
    np.savez(tmp_path / "a.npz", noise_0_weight0=exact, noise_0_bias0=exact[0], band_scale=1.0)
    pack(tmp_path / "all.npz", {"a": tmp_path / "a.npz"})
    with_band(
        tmp_path / "all.npz", 1.3, np.ones((3, 2)), "by a test"
    )  # what is in bytes stays as it is
    with np.load(tmp_path / "all.npz") as stored:
        assert stored["a/noise_0_weight0"].dtype == np.int8
        assert stored["a/noise_0_bias0"].dtype == np.float64
        arrays = {key.removeprefix("a/"): stored[key] for key in stored.files}
    half_steps = 0.51 * np.abs(exact).max(axis=1, keepdims=True) / 31.0
    assert (np.abs(exact_array(arrays, "noise_0_weight0") - exact) <= half_steps).all()


@pytest.mark.slow
@pytest.mark.usefixtures("chart_curves")
def test_all_weights_can_be_made_again_from_the_data(development_data, tmp_path):
    """Few photos and one pass: what comes out is of no use, but is all there and can be asked."""
    pytest.importorskip("torch", reason="needs the extra train")
    few = ["--parts", "2", "--epochs", "1", "--members", "1", "--band-photos", "4"]
    made, held_out = tmp_path / "joint.npz", tmp_path / "held_out.npz"
    (tmp_path / "portraits").mkdir()
    write(tmp_path / "portraits" / "hopper.png", grace_hopper(), "uint8")
    told = CliRunner().invoke(
        main,
        [
            *("reproduce", "--data", str(development_data), "--processes", "1", *few),
            *("--portraits", str(tmp_path / "portraits"), "--work", str(tmp_path)),
            *("-o", str(made), "--held-out", str(held_out)),
        ],
    )
    assert told.exit_code == 0, told.output
    assert "4 photos: 90 % of all codes within" in told.output
    with np.load(made) as stored:
        made_by = json.loads(str(stored["made_by"]))
    assert (made_by["parts"], made_by["epochs"], made_by["members"]) == (2, 1, 1)
    assert made_by["portraits"] == 1
    assert set(made_by["data_sha256"]) >= {"dorf_201_curves.mat", "heads", "scenes"}
    assert made_by["band_measured"].endswith("--photos 4 --seed 2")
    evidence = gather(Photo(grace_hopper(), bit_depth=8), networks=load_joint(made).networks)
    assert conclude([evidence], model=load_joint(made)).found is not None
    held_out_joint.cache_clear()  # the band was measured with them as they were before it was set
    for name in held_out_names():
        assert held_out_joint(held_out, name).band_scale == load_joint(made).band_scale
