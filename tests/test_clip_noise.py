"""Noise of frames that follow one another: the exponent that points leave open."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from archive_photos import linear_face
from PIL import Image

from facecrf_ocio.clip.calibrate_clip import calibrate_clip
from facecrf_ocio.clip.clip_source import open_clip
from facecrf_ocio.clip.frame_noise import noise_levels
from facecrf_ocio.clip.jpeg_frames import holds_jpeg
from facecrf_ocio.clip.noise_light import add_noise
from facecrf_ocio.joint import shipped_joint
from facecrf_ocio.joint.prior import Posterior
from facecrf_ocio.synthetic.jpeg import through_jpeg

PRIOR = shipped_joint().prior
KNOWN_NOTHING = PRIOR.posterior(None, PRIOR.weights_for("auto"))
GRID = np.linspace(0.0, 1.0, 1024)
ELECTRONS = 15_000.0  # at white: ISO 400 of a full-frame camera
READING = 5.0  # electrons
SHIFT = 5  # [px] by which the second frame is moved


def scene():
    """Flat patches of 24 px, of all levels and several colors."""
    generator = np.random.default_rng(3)
    levels = np.exp2(generator.uniform(-10.0, -0.3, (20, 32, 1)))
    colors = np.exp2(generator.uniform(-0.4, 0.4, (20, 32, 3)))
    return np.minimum(levels * colors, 1.0).repeat(24, axis=0).repeat(24, axis=1)


def frames(exponent, electrons=ELECTRONS):
    """Two frames, each with noise of its own, as 8-bit code values over 255."""
    light, generator = scene(), np.random.default_rng(1)
    shown = []
    for moved in (0, SHIFT):
        seen = np.roll(light, moved, axis=1)
        deviation = np.sqrt(seen / electrons + (READING / electrons) ** 2)
        noisy = seen + deviation * generator.standard_normal(seen.shape)
        shown.append(np.rint(255.0 * np.clip(noisy, 0.0, 1.0) ** (1.0 / exponent)) / 255.0)
    return tuple(np.asarray(frame, np.float32) for frame in shown)


@pytest.mark.parametrize("exponent", [1.8, 2.2, 2.6])
def test_noise_gives_the_curve_with_its_exponent(exponent):
    found = add_noise(KNOWN_NOTHING, noise_levels([frames(exponent)]), PRIOR, 1.0)
    curve = PRIOR.samples(found.mean)
    codes = np.linspace(64, 235, 50) / 255.0
    apart = np.log2(np.interp(codes, PRIOR.grid, curve) / codes**exponent)
    assert (
        np.abs(apart - np.interp(0.5, codes, apart)).mean() < 0.1
    )  # [stop]; reading noise is unknown


def test_variance_is_that_of_one_frame_through_movement():
    levels = noise_levels([frames(1.0)])  # of a straight line: a (g + b), by luminance
    weights = np.array([0.2126, 0.7152, 0.0722]) ** 2
    light = levels.codes + READING**2 / ELECTRONS
    true = 255.0**2 * (light @ weights) / ELECTRONS + weights.sum() / 12.0
    assert levels.variance == pytest.approx(true, rel=0.15)
    assert levels.finest == pytest.approx(1.0, abs=0.1)


def test_what_an_encoder_left_of_noise_is_not_believed():
    compressed = [
        through_jpeg(np.rint(255.0 * frame).astype(np.uint8), 90).astype(np.float32) / 255.0
        for frame in frames(2.2)
    ]
    assert add_noise(KNOWN_NOTHING, noise_levels([compressed]), PRIOR, 1.0) is None


def test_noise_that_rounding_swallows_is_not_believed():
    levels = noise_levels([frames(2.2, electrons=1e6)])
    assert add_noise(KNOWN_NOTHING, levels, PRIOR, 1.0) is None


def test_noise_that_contradicts_the_faces_is_not_believed():
    """As where a camera's denoising bends it: here noise that grows with the square of light."""
    light, generator, shown = scene(), np.random.default_rng(2), []
    for _ in range(2):
        noisy = light * (1.0 + 0.01 * generator.standard_normal(light.shape)) + 1e-3
        shown.append(np.rint(255.0 * np.clip(noisy, 0.0, 1.0) ** (1.0 / 2.2)) / 255.0)
    levels = noise_levels([tuple(np.asarray(frame, np.float32) for frame in shown)])
    sure = PRIOR.posterior(None, PRIOR.weights_for("auto"))
    faces = Posterior(np.ones(1), sure.mean[None], 0.05 * sure.covariance[None])
    assert add_noise(faces, levels, PRIOR, 1.0) is None


def sure_of(exponent):
    """Faces that know a curve better than most do."""
    root = np.linspace(0.0, 1.0, PRIOR.grid.size) ** (exponent / 2.0)
    mean = np.linalg.lstsq(PRIOR.basis.T, root - PRIOR.mean, rcond=None)[0]
    return Posterior(np.ones(1), mean[None], 0.05 * KNOWN_NOTHING.covariance[None])


def moved(faces, levels):
    """[stop] by which noise moves the curve that faces give, RMS over codes after a scale."""
    found = add_noise(faces, levels, PRIOR, 1.0) or faces
    codes = np.linspace(64, 235, 50) / 255.0
    lights = [np.interp(codes, PRIOR.grid, PRIOR.samples(one.mean)) for one in (found, faces)]
    return float(np.std(np.log2(lights[0] / lights[1])))


def test_faces_that_are_sure_are_hardly_moved_by_noise_that_strays():
    levels, generator = noise_levels([frames(2.2)]), np.random.default_rng(7)
    strays = np.exp(0.2 * generator.standard_normal((10, levels.variance.size)))
    straying = [replace(levels, variance=levels.variance * one) for one in strays]
    assert np.mean([moved(sure_of(2.2), one) for one in straying]) < 0.02  # [stop]


def test_noise_is_believed_less_the_more_of_it_an_encoder_took():
    levels = noise_levels([frames(2.4)])
    shares = [np.full(levels.finest.size, share) for share in (1.0, 0.8, 0.6)]
    whole, less, least = (moved(sure_of(2.2), replace(levels, finest=one)) for one in shares)
    assert whole > 1.2 * less > 1.44 * least


def test_few_levels_tell_nothing():
    flat = np.full((64, 64, 3), 0.5, np.float32)
    assert add_noise(KNOWN_NOTHING, noise_levels([(flat, flat)]), PRIOR, 1.0) is None
    assert add_noise(KNOWN_NOTHING, noise_levels([]), PRIOR, 1.0) is None


def test_texture_is_no_noise():
    """Of a still scene with fine texture, whose two frames differ by noise alone."""
    light = scene() * np.exp2(0.2 * np.random.default_rng(5).standard_normal((480, 768, 1)))
    generator, shown = np.random.default_rng(6), []
    for _ in range(2):
        noisy = light + np.sqrt(light / ELECTRONS) * generator.standard_normal(light.shape)
        shown.append(np.rint(255.0 * np.clip(noisy, 0.0, 1.0)).astype(np.float32) / 255.0)
    weights = np.array([0.2126, 0.7152, 0.0722]) ** 2
    levels = noise_levels([tuple(shown)])
    true = 255.0**2 * (levels.codes @ weights) / ELECTRONS + weights.sum() / 12.0
    assert levels.variance == pytest.approx(true, rel=0.1)
    assert cv2.absdiff(*shown).mean() * 255.0 < 2.0


@pytest.mark.parametrize(
    ("name", "kind", "options", "jpeg"),
    [
        ("a.jpg", "JPEG", {}, True),
        ("a.png", "JPEG", {}, True),
        ("a.jpg", "PNG", {}, False),
        ("a.tif", "TIFF", {"compression": "jpeg"}, True),
        ("a.tif", "TIFF", {"compression": "tiff_lzw"}, False),
    ],
)
def test_a_frame_is_a_jpeg_by_its_content_and_not_by_its_name(tmp_path, name, kind, options, jpeg):
    codes = np.random.default_rng(0).integers(0, 255, (32, 32, 3), np.uint8)
    Image.fromarray(codes).save(tmp_path / name, kind, **options)
    assert holds_jpeg(tmp_path / name) is jpeg


@pytest.mark.parametrize(
    ("codec", "format_", "jpeg"),
    [
        ("mjpeg", "yuvj420p", True),
        ("libx264", "yuv420p", False),
    ],
)
def test_a_video_of_motion_jpeg_says_so(tmp_path, codec, format_, jpeg):
    av = pytest.importorskip("av")
    with av.open(str(tmp_path / "a.mkv"), "w") as container:
        stream = container.add_stream(codec, rate=24)
        stream.width, stream.height, stream.pix_fmt = 64, 48, format_
        for _ in range(3):
            frame = av.VideoFrame.from_ndarray(np.full((48, 64, 3), 99, np.uint8), format="rgb24")
            container.mux(stream.encode(frame.reformat(format=format_)))
        container.mux(stream.encode(None))
    assert open_clip(tmp_path / "a.mkv").motion_jpeg is jpeg


@pytest.mark.slow
def test_a_sequence_tells_by_its_noise_unless_it_is_of_jpegs(tmp_path):
    """JPEG's steps bend noise against level, and do not always show in its structure."""
    light = cv2.resize(linear_face(3), None, fx=3.0, fy=3.0, interpolation=cv2.INTER_CUBIC)
    generator = np.random.default_rng(4)
    told = {}
    for case, jpeg in (("png", False), ("jpg", True), ("jpg named png", True)):
        for number in range(3):
            seen = np.clip(np.roll(light, 2 * number, axis=1), 0.0, 1.0)
            deviation = np.sqrt(seen / ELECTRONS + (READING / ELECTRONS) ** 2)
            noisy = seen + deviation * generator.standard_normal(seen.shape)
            codes = np.rint(255.0 * np.clip(noisy, 0.0, 1.0) ** (1.0 / 2.2)).astype(np.uint8)
            path = tmp_path / case / f"frame.{number + 1:04d}.{case[-3:]}"
            path.parent.mkdir(exist_ok=True)
            Image.fromarray(codes).save(path, "JPEG" if jpeg else "PNG", quality=100)
        told[case] = calibrate_clip(open_clip(tmp_path / case), frames=2).noise_told
    assert told == {"png": True, "jpg": False, "jpg named png": False}
