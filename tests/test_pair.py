"""A camera's response from its raw file and JPEG: known curves come back, wrong pairs do not."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from io import BytesIO

import cv2
import numpy as np
import pytest
from click.testing import CliRunner
from command_line import CommandLine
from photo_files import write_dng
from PIL import Image

from facecrf_ocio.cameras.known_cameras import matching, read_registry
from facecrf_ocio.cli.facecrf import main
from facecrf_ocio.color.working_space import working_space_matrix
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.image.apply import apply_lut
from facecrf_ocio.pair.align import align
from facecrf_ocio.pair.calibrate_pair import calibrate_pair
from facecrf_ocio.pair.extrapolate import continued
from facecrf_ocio.pair.fit_channel import fit_channel
from facecrf_ocio.pair.flat_pixels import Samples
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.record.calibration_record import read_record
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.response.stops import stops_error, uniform
from facecrf_ocio.values import Photo, Verdict

GRID = np.linspace(0.0, 1.0, 1024)
# One curve for each channel, none of them sRGB's nor in the span of the model's eigenvectors.
TRUTH = np.stack([GRID**2.1, 0.15 * GRID + 0.85 * GRID**2.6, 0.5 * GRID**1.7 + 0.5 * GRID**3])
MATRIX = np.array([[1.5, -0.3, -0.1], [-0.15, 1.3, -0.1], [0.02, -0.35, 1.4]])


def scene(seed=0, height=420, width=560):
    """(H, W, 3) linear light in [0.003, 0.8]: smooth patches of many colors and brightnesses."""
    random = np.random.default_rng(seed)

    def smooth(sigma, channels):
        noise = random.standard_normal((height, width, channels)).astype(np.float32)
        blurred = cv2.GaussianBlur(noise, (0, 0), sigma).reshape(height, width, channels)
        return blurred / blurred.std()

    stops = -2.2 + 1.7 * smooth(14, 1) + 0.35 * smooth(9, 3) + 0.3 * smooth(3, 1)
    return np.clip(2.0**stops, 0.003, 0.8).astype(np.float64)


def develop(linear, truth=TRUTH, matrix=MATRIX):
    """What the camera makes of it, before it rounds."""
    mixed = np.clip(linear @ matrix.T, 0.0, 1.0)
    return np.stack([np.interp(mixed[..., c], truth[c], GRID) for c in range(3)], axis=2)


def stored(encoded):
    return Photo((np.rint(encoded * 255) / 255).astype(np.float32), bit_depth=8)


def linear_photo(linear):
    return Photo(linear.astype(np.float32), scene_linear=True)


def mosaic(linear):
    """RGGB mosaic as the tests' DNG takes it."""
    result = 60000.0 * linear[..., 1]
    result[::2, ::2] = 60000.0 * linear[::2, ::2, 0]
    result[1::2, 1::2] = 60000.0 * linear[1::2, 1::2, 2]
    return result


def errors(curve, truth=TRUTH):
    estimated = [np.interp(GRID, curve.encoded, row) for row in curve.linear]
    return np.sqrt(((np.array(estimated) - truth) ** 2).mean(axis=1))


def test_curve_and_matrix_come_back():
    linear = scene()
    found = calibrate_pair(linear_photo(linear), stored(develop(linear)))
    assert errors(found.estimate.curve).max() < 0.01
    assert np.allclose(found.matrix, MATRIX, atol=0.03)
    assert max(found.residual_codes) < 1.0
    assert found.estimate.confidence.verdict is Verdict.RELIABLE


def with_own_curves(exponents):
    """The verdict of a pair whose channels have powers of their own, none of them at white."""
    curves = np.array([0.1 * GRID + 0.9 * GRID**one for one in exponents])
    linear = 0.5 * scene(8)
    return calibrate_pair(linear_photo(linear), stored(develop(linear, curves, np.eye(3))))


def test_the_verdict_is_that_of_the_told_error():
    alike = with_own_curves((2.4, 2.4, 2.4)).estimate.confidence
    apart = with_own_curves((1.6, 2.4, 3.2)).estimate.confidence
    assert alike.in_stops.mid < 0.1 < apart.in_stops.mid
    assert alike.verdict is Verdict.RELIABLE
    assert apart.verdict is Verdict.WEAK


@pytest.mark.parametrize("tint", [(0.9, 0.5, 0.3), (0.35, 0.6, 0.4)])
def test_equal_curves_stay_equal_where_no_channel_reaches_white(tint):
    """Gains are free, so it is the way to white that decides whether grays keep a cast."""
    linear = scene(8) * tint
    equal = np.tile(0.15 * GRID + 0.85 * GRID**2.6, (3, 1))
    encoded = develop(linear, equal, np.eye(3))
    assert np.quantile(encoded, 0.99, axis=(0, 1)).max() < 0.95
    found = calibrate_pair(linear_photo(linear), stored(encoded)).estimate.curve
    stops = np.log2(np.array([np.interp(np.arange(64, 192) / 255, GRID, row) for row in equal]))
    own = [np.interp(np.arange(64, 192) / 255, found.encoded, row) for row in found.linear]
    away = np.log2(own) - stops
    assert np.ptp(away.mean(axis=1)) < 0.03
    assert np.abs(away - away.mean()).max() < 0.05


def test_crop_turn_and_size_are_undone():
    linear = scene(1)
    cut = develop(linear)[24:400, 40:530]
    smaller = cv2.resize(cut, None, fx=0.8, fy=0.8, interpolation=cv2.INTER_AREA)
    found = calibrate_pair(linear_photo(linear), stored(np.rot90(smaller)))
    assert errors(found.estimate.curve).max() < 0.015


def test_lens_correction_is_undone():
    linear = scene(2)
    height, width = linear.shape[:2]
    y, x = np.mgrid[:height, :width].astype(np.float32)
    radius = ((x - width / 2) ** 2 + (y - height / 2) ** 2) / (width / 2) ** 2
    factor = 1 - 0.012 * radius
    bent = cv2.remap(
        linear.astype(np.float32),
        width / 2 + (x - width / 2) * factor,
        height / 2 + (y - height / 2) * factor,
        cv2.INTER_CUBIC,
    )
    photo = stored(develop(np.clip(bent, 0.0, 1.0)))
    straight = linear_photo(linear)
    aligned = align(straight, photo)
    assert aligned.lens_shift > 0.3
    true = bent.astype(np.float64)[aligned.both]
    left = np.median(np.abs(aligned.linear[aligned.both] / true - 1))
    untreated = np.median(np.abs(linear / bent - 1))
    assert left < 0.008 < 0.4 * untreated
    assert errors(calibrate_pair(straight, photo).estimate.curve).max() < 0.015


def test_retouched_spots_do_not_matter():
    linear = scene(3)
    encoded = develop(linear)
    encoded[100:180, 100:220] *= 0.6
    found = calibrate_pair(linear_photo(linear), stored(encoded))
    assert errors(found.estimate.curve).max() < 0.015


def test_another_picture_is_refused():
    with pytest.raises(PhotoError, match="is not the picture that"):
        calibrate_pair(linear_photo(scene(4)), stored(develop(scene(5))))


def test_local_tone_mapping_is_refused():
    linear = scene(6)
    random = cv2.GaussianBlur(
        np.random.default_rng(0).standard_normal(linear.shape[:2]), (0, 0), 30
    )
    local = 2.0 ** (1.5 * random / random.std())[..., None]
    with pytest.raises(PhotoError, match=r"no curve joins them|agree by"):
        calibrate_pair(linear_photo(linear), stored(develop(np.clip(linear * local, 0, 1))))


def test_a_flat_picture_is_refused():
    linear = np.clip(0.3 + 0.01 * (scene(7) - 0.3), 0, 1)
    with pytest.raises(PhotoError, match="too few to see a curve"):
        calibrate_pair(linear_photo(linear), stored(develop(linear)))


def test_kinds_are_checked():
    linear = scene()
    with pytest.raises(PhotoError, match="too coarse for linear light"):
        calibrate_pair(stored(linear), stored(develop(linear)))
    with pytest.raises(PhotoError, match="has no response to find"):
        calibrate_pair(linear_photo(linear), linear_photo(linear))


def test_beyond_its_samples_a_curve_goes_on_like_known_ones():
    model = dorf_model()
    srgb = fixed_curve("srgb", model.grid, model)
    seen = (model.grid > 0.05) & (model.grid < 0.75)
    assert np.abs(continued(0.4 * srgb, seen, model) - srgb).max() < 0.005
    likely = model.samples(np.array([0.5, -0.2, 0.05, 0.0, 0.0]))
    assert np.abs(continued(3.0 * likely, seen, model) - likely).max() < 0.05


def test_one_channel_of_exact_samples():
    light = np.random.default_rng(0).uniform(0.0, 0.95, (3000, 3))
    encoded = np.sqrt(0.9 * light[:, 0] + 0.1 * light[:, 1])
    fit = fit_channel(Samples(encoded, light), 0, GRID**2.4, 1024)
    assert np.abs(fit.linear - GRID**2).max() < 0.003
    assert np.allclose(fit.mixing, [0.9, 0.1, 0.0], atol=0.003)


@pytest.fixture
def pair_files(tmp_path):
    """A DNG and a JPEG of a shifted crop of it, through the known curves."""
    linear = scene(8)
    shift = np.array([[1, 0, 10.4], [0, 1, 7.7]])
    crop = cv2.warpAffine(linear, shift, (520, 390), flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP)
    codes = np.rint(255 * develop(np.clip(crop, 0, 1))).astype(np.uint8)
    Image.fromarray(codes).save(tmp_path / "photo.jpg", quality=95, subsampling=0)
    return write_dng(tmp_path / "photo.dng", mosaic(linear)), tmp_path / "photo.jpg"


def run(*arguments):
    return CliRunner().invoke(main, ["pair", *map(str, arguments)])


def test_command_writes_what_calibrate_writes(pair_files, tmp_path):
    result = run(*pair_files, "-o", tmp_path / "out", "--plot")
    assert result.exit_code == 0, result.output
    names = {path.name for path in (tmp_path / "out").iterdir()}
    luts = {"photo.jpg.spi1d", "photo.jpg.cube", "photo.jpg.clf"}
    assert names == luts | {"photo.jpg.crf.json", "photo.jpg.crf.png"}
    record = read_record(tmp_path / "out" / "photo.jpg.crf.json")
    assert record.estimate.estimator == "pair"
    assert record.source.name == "photo.jpg"
    assert errors(record.estimate.curve).max() < 0.02
    assert run(*pair_files, "-o", tmp_path / "out").exit_code == 1  # nothing is overwritten


def test_command_writes_the_way_back_and_on_to_a_working_space(pair_files, tmp_path):
    out = tmp_path / "out"
    options = ("--formats", "clf", "--direction", "both", "--to", "acescg")
    result = run(*pair_files, "-o", out, *options)
    assert result.exit_code == 0, result.output
    there, back = out / "photo.jpg.acescg.clf", out / "photo.jpg.acescg.encode.clf"
    assert {p.name for p in out.iterdir()} == {there.name, back.name, "photo.jpg.crf.json"}
    photo = replace(read_photo(pair_files[1]), bit_depth=None)
    linear = apply_lut(photo, there)
    curve = read_record(out / "photo.jpg.crf.json").estimate.found
    wanted = curve.linearize(photo.encoded) @ working_space_matrix(photo.primaries, "acescg").T
    assert np.abs(linear - wanted).max() < 1e-5
    encoded = apply_lut(replace(photo, encoded=linear), back, "encode")
    assert np.abs(encoded - photo.encoded).max() < 1e-3
    refused = run(*pair_files, "-o", out, "--formats", "cube", "--to", "acescg")
    assert refused.exit_code == 2
    assert ".cube cannot hold the matrix to acescg; use clf or ctf" in refused.stderr


def test_command_refuses_another_picture_in_one_line(pair_files, tmp_path):
    raw, _ = pair_files
    other = tmp_path / "other.jpg"
    Image.fromarray(np.rint(255 * develop(scene(9))).astype(np.uint8)).save(other)
    result = run(raw, other, "-o", tmp_path / "out")
    assert result.exit_code == 3
    assert len(result.stderr.splitlines()) == 1
    assert "other.jpg: is not the picture that photo.dng shows" in result.stderr
    assert not (tmp_path / "out").exists()


def raw_with_picture(path, linear, *, factor=1.0, **signed):
    """A DNG that holds what the camera made of it, `factor` times as large."""
    made = cv2.resize(develop(linear), None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA)
    jpeg = BytesIO()
    Image.fromarray(np.rint(255 * made).astype(np.uint8)).save(
        jpeg, "JPEG", quality=95, subsampling=0
    )
    return write_dng(path, mosaic(linear), picture=jpeg.getvalue(), **signed)


@pytest.mark.parametrize("factor", [1.0, 0.5])
def test_without_a_jpeg_the_picture_in_the_raw_file_is_taken(tmp_path, factor):
    raw = raw_with_picture(tmp_path / "photo.dng", scene(8), factor=factor)
    result = run(raw, "-o", tmp_path / "out", "--formats", "clf")
    assert result.exit_code == 0, result.output
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert written == {"photo.dng.clf", "photo.dng.crf.json"}
    record = read_record(tmp_path / "out" / "photo.dng.crf.json")
    assert errors(record.estimate.curve).max() < 0.02
    assert record.source.name == "photo.dng"
    assert record.source.sha256 == hashlib.sha256(raw.read_bytes()).hexdigest()
    assert record.source.camera.model == "Raw One"
    same = calibrate_pair(raw).estimate
    assert np.allclose(same.curve.linear, record.estimate.curve.linear, atol=1e-6)


def test_raw_files_measure_their_camera(tmp_path, capfd, monkeypatch):
    """All of one model together; files that give nothing are told, and none counts twice."""
    registry = tmp_path / "cameras.json"
    monkeypatch.setenv("FACECRF_CAMERAS", str(registry))
    folder = tmp_path / "raws"
    folder.mkdir()
    for seed in (8, 9, 10):
        raw_with_picture(folder / f"{seed}.dng", scene(seed), factor=0.5)
    write_dng(folder / "bare.dng", mosaic(scene(8)))
    measure = CommandLine(capfd)
    one = measure("cameras", "measure", folder / "9.dng")
    assert "Acme Raw One: by 1 raw file, grade B" in one.out
    ended = measure("cameras", "measure", folder)
    assert ended.code == 0
    assert "Acme Raw One: by 3 raw files, 0.06 stops apart, grade A" in ended.out
    assert "bare.dng: holds no JPEG by the camera" in ended.err
    (found,) = read_registry(registry)
    assert errors(found.curve).max() < 0.02
    assert found.proof.count("sha256") == 3
    # A maker's JPEGs begin the model with its name, raw files do not.
    assert matching([found], "Acme", "Acme Raw One") == (found,)
    assert measure("cameras", "measure", folder / "bare.dng").code != 0


@pytest.mark.parametrize("software", [b"Adobe DNG Converter 15.4", b"Adobe Photoshop Lightroom"])
def test_a_converters_picture_is_no_cameras(tmp_path, software):
    raw = raw_with_picture(tmp_path / "photo.dng", scene(8), software=software)
    with pytest.raises(PhotoError, match="no picture by the camera, but one by Adobe"):
        calibrate_pair(raw)


def test_a_raw_file_without_a_picture_says_what_to_give(tmp_path):
    raw = write_dng(tmp_path / "photo.dng", mosaic(scene(8)))
    result = run(raw, "-o", tmp_path / "out")
    assert result.exit_code == 3
    assert result.stderr.strip().endswith(
        "holds no JPEG by the camera; give the camera's JPEG of the same exposure as well"
    )
    assert not (tmp_path / "out").exists()


def test_what_is_no_raw_file_holds_no_cameras_picture(pair_files, tmp_path):
    result = run(pair_files[1], "-o", tmp_path / "out")
    assert result.exit_code == 3
    assert "is not camera raw that LibRaw knows" in result.stderr
    with pytest.raises(PhotoError, match="has no file that could hold the camera's picture"):
        calibrate_pair(linear_photo(scene(8)))


@pytest.mark.slow
def test_real_pair_of_a_raw_development(development_data):
    folder = development_data / "faces" / "linear"
    linear = read_photo(folder / "portrait_leaves_linear_rec2020.png")
    encoded = read_photo(folder / "portrait_leaves_encoded_16bit.png")
    found = calibrate_pair(replace(linear, scene_linear=True), encoded)
    srgb = fixed_curve("srgb", GRID, dorf_model())
    assert errors(found.estimate.curve, srgb).max() < 0.005
    # ITU-R BT.2020 to BT.709
    rec2020 = [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]]
    row_scale = found.matrix.sum(axis=1, keepdims=True)
    assert np.abs(found.matrix / row_scale - rec2020).max() < 0.02


@pytest.mark.parametrize(("gain", "most"), [(1.0, 0.02), (0.35, 0.12)])
def test_what_is_told_is_what_the_curve_errs_by(gain, most):
    """White out of sight widens the band, and the shape in stops as far as codes are out of it."""
    linear = scene(9) * gain
    equal = np.tile(0.15 * GRID + 0.85 * GRID**2.6, (3, 1))
    estimate = calibrate_pair(
        linear_photo(linear), stored(develop(linear, equal, np.eye(3)))
    ).estimate
    error = stops_error(uniform(estimate.curve), equal)
    told = estimate.confidence.in_stops
    assert error.mid < 3.0 * told.mid
    assert told.mid < most
    truth = np.array([np.interp(estimate.curve.encoded, GRID, row) for row in equal])
    away = np.abs(estimate.curve.linear - truth)
    assert (away <= 1.645 * estimate.confidence.sigma + 1e-4).mean() > 0.9
