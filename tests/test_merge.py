"""Merging a bracket: the light of the scene comes back, and things that moved leave no ghosts."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from archive_photos import exposed, write_picture
from command_line import CommandLine
from photo_files import pixels_of

from facecrf_ocio.benchmark.peers import merge_errors
from facecrf_ocio.pair.bracket_pixels import flat_patches, small_bracket
from facecrf_ocio.pair.merge import merge_bracket, refined_stops
from facecrf_ocio.record.calibration_record import write_record
from facecrf_ocio.settings import Settings
from facecrf_ocio.synthetic import encode, gamma_curve
from facecrf_ocio.values import Estimate, Outcome, Photo

CURVE = gamma_curve(2.2)
STOPS = np.array([-4.0, -2.0, 0.0, 2.0])
SIZE = 200


def soft(generator, shape):
    """Noise of [0, 1], as smooth as out of focus."""
    noise = cv2.GaussianBlur(generator.normal(size=shape).astype(np.float32), (0, 0), 16.0)
    return (noise - noise.min()) / np.ptp(noise)


def scene():
    """(200, 200, 3) light from 1/64 to 8, and colors up to a stop from gray."""
    generator = np.random.default_rng(5)
    stops = 9.0 * soft(generator, (SIZE, SIZE, 1))[..., None] - 6.0
    return np.exp2(stops + soft(generator, (SIZE, SIZE, 3)) - 0.5).astype(np.float32)


def shot(light, stop, seed):
    generator = np.random.default_rng(seed)
    exposed_light = light * 2.0**stop
    deviation = np.sqrt(1e-5 + 1e-4 * exposed_light)
    noisy = exposed_light + generator.normal(size=light.shape) * deviation
    codes = np.rint(encode(np.clip(noisy, 0, 1).astype(np.float32), CURVE) * 255) / 255
    return Photo(codes.astype(np.float32), bit_depth=8)


def stops_off(merged, light, where=...):
    error = np.log2(np.maximum(merged, 1e-6) / light).mean(axis=2)[where]
    return float(np.sqrt(np.mean((error - np.median(error)) ** 2)))


def with_a_ball(light, x):
    """A dark ball that stands at x."""
    return cv2.circle(light.copy(), (x, 100), 22, (0.05,) * 3, -1)


def merged_of(photos, **how):
    bracket = small_bracket(photos, STOPS)
    return merge_bracket(lambda index: photos[index], bracket, CURVE, **how)


def opencv(photos, reference):
    """OpenCV's Debevec merge, given the same curve and times."""
    images = [np.rint(p.encoded * 255).astype(np.uint8) for p in photos]
    levels = np.linspace(0, 1, 256)
    response = np.stack([np.interp(levels, CURVE.encoded, row) for row in CURVE.linear], axis=1)
    response = np.maximum(response, 1e-5)[:, None].astype(np.float32)
    times = np.exp2(STOPS - STOPS[reference]).astype(np.float32)
    return cv2.createMergeDebevec().process(images, times, response)


def test_light_comes_back_over_nine_stops_nearer_than_by_opencv():
    light = scene()
    photos = [shot(light, stop, n) for n, stop in enumerate(STOPS)]
    ours = merged_of(photos)
    assert stops_off(ours.linear, light) < 0.03
    reference = next(n for n, p in enumerate(photos) if p is ours.reference)
    assert stops_off(ours.linear, light) < 0.5 * stops_off(opencv(photos, reference), light)
    # In the reference's units: 1 is its white.
    ratio = ours.linear / (light * 2.0 ** STOPS[reference])
    assert np.median(ratio) == pytest.approx(1.0, abs=0.02)


def test_what_moved_is_shown_once():
    light = scene()
    photos = [shot(with_a_ball(light, 40 + 35 * n), stop, n) for n, stop in enumerate(STOPS)]
    ours = merged_of(photos)
    reference = next(n for n, p in enumerate(photos) if p is ours.reference)
    truth = with_a_ball(light, 40 + 35 * reference)
    ghosts = merged_of(photos, still=True)
    assert stops_off(ours.linear, truth) < 0.5 * stops_off(ghosts.linear, truth)
    assert max(ours.moved) > 0.02
    assert ours.moved[reference] == 0.0


def test_a_still_scene_has_nothing_set_aside():
    photos = [shot(scene(), stop, n) for n, stop in enumerate(STOPS)]
    assert max(merged_of(photos).moved) < 0.01


def a_window(light):
    """Light with a bright window that has bars: its edges lie next to clipping."""
    lit = light.copy()
    lit[40:160, 60:150] *= 24.0
    lit[96:102, 60:150] *= 0.1
    lit[40:160, 100:104] *= 0.1
    return cv2.GaussianBlur(lit, (0, 0), 1.0)


def as_jpeg(photo):
    codes = np.rint(photo.encoded[..., ::-1] * 255).astype(np.uint8)
    packed = cv2.imencode(".jpg", codes, [cv2.IMWRITE_JPEG_QUALITY, 88])[1]
    return Photo(cv2.imdecode(packed, cv2.IMREAD_COLOR)[..., ::-1] / np.float32(255), bit_depth=8)


@pytest.mark.parametrize("gamma", [2.2, 2.35])
def test_a_window_next_to_clipping_is_no_movement(gamma):
    light = a_window(scene())
    photos = [as_jpeg(shot(light, stop, n)) for n, stop in enumerate(STOPS)]
    curve = gamma_curve(gamma)  # the camera's, or one as wrong as its deviation allows
    sigma = curve.linear * np.abs(np.log(np.maximum(curve.encoded, 1e-9))) * 0.1
    bracket = small_bracket(photos, STOPS)
    merged = merge_bracket(lambda index: photos[index], bracket, curve, sigma=sigma)
    still = merge_bracket(lambda index: photos[index], bracket, curve, still=True)
    assert max(merged.moved) < 0.001
    np.testing.assert_allclose(merged.linear, still.linear, rtol=0.01)


def test_what_passed_before_a_clipped_window_is_shown_once():
    light = a_window(scene())
    # Longest first: the reference, which clips the window, shows no ball before it.
    photos = [
        as_jpeg(shot(light if stop >= -2 else with_a_ball(light, 105), stop, n))
        for n, stop in enumerate(STOPS)
    ]
    merged = merged_of(photos)
    assert merged.moved[0] > 0.02
    ghosts = merged_of(photos, still=True)
    assert stops_off(merged.linear, light) < 0.5 * stops_off(ghosts.linear, light)


@pytest.mark.slow
def test_a_real_bracket_from_a_tripod_has_no_patches(development_data, capfd, tmp_path):
    folder = development_data / "stacks" / "canon_5d_corridor"
    if not folder.is_dir():
        pytest.skip("the public bracket of a corridor is not there")
    photos = [folder / f"00{number:02d}.jpg" for number in (2, 6, 10, 14, 18, 22)]
    found = []
    for name, how in (("all", ()), ("still", ("--still",))):
        target = tmp_path / f"{name}.exr"
        ended = CommandLine(capfd)("merge", *photos, "-o", target, *how)
        assert ended.code == 0, ended.err
        found.append(np.log2(np.maximum(pixels_of(target)[..., :3], 1e-4)))
    # Nothing moved but a tree before the window: before, a hundredth of the pixels were patches.
    assert np.mean(np.abs(found[0] - found[1]).max(axis=2) > 0.1) < 0.001


def test_a_hand_that_moved_is_undone():
    light = scene()
    turns = [cv2.getRotationMatrix2D((100, 100), 0.8 * n, 1.0) for n in range(4)]
    for n, turn in enumerate(turns):
        turn[:, 2] += (2.0 * n, -1.5 * n)
    moved = [cv2.warpAffine(light, t, (SIZE, SIZE), borderMode=cv2.BORDER_REFLECT) for t in turns]
    photos = [shot(one, stop, n) for n, (one, stop) in enumerate(zip(moved, STOPS, strict=True))]
    ours = merged_of(photos)
    reference = next(n for n, p in enumerate(photos) if p is ours.reference)
    inner = (slice(30, 170), slice(30, 170))
    assert stops_off(ours.linear, moved[reference], inner) < 0.06


def test_exposures_are_refined_by_a_known_curve():
    photos = [shot(scene(), stop, n) for n, stop in enumerate(STOPS + np.eye(4)[1] / 10)]
    bracket = small_bracket(photos, STOPS)
    found = refined_stops(STOPS, *flat_patches(bracket, center_only=False), CURVE)
    assert np.diff(found)[1] == pytest.approx(1.9, abs=0.03)


@pytest.mark.slow
def test_the_command_writes_a_tagged_exr(capfd, tmp_path):
    photos = [
        write_picture(tmp_path / f"{n}.jpg", scene() * np.float32(2.0**s), CURVE, **exposed(n, s))
        for n, s in enumerate((-4, -2, 0, 2))
    ]
    target = tmp_path / "hdr.exr"
    ended = CommandLine(capfd)("merge", *photos, "-o", target)
    assert ended.code == 0, ended.err
    pixels, spec = pixels_of(target), oiio.ImageBuf(str(target)).spec()
    assert pixels.max() > 1.5
    assert spec["facecrf:estimator"] == "bracket"
    assert "0.jpg" in spec["facecrf:bracket"]
    assert spec["oiio:ColorSpace"] == "unknown"  # the photos tell no primaries
    again = CommandLine(capfd)("merge", *photos, "-o", target)
    assert again.code == 1


def test_photos_that_are_not_exposed_as_they_tell_are_named(capfd, tmp_path):
    photos = [
        write_picture(tmp_path / f"{n}.jpg", scene() * np.float32(0.25), CURVE, **exposed(n, s))
        for n, s in enumerate((-4, -2, 0, 2))
    ]
    known = Estimate(Outcome.CALIBRATED, "chart", "", found=CURVE)
    photo = replace(shot(scene(), 0.0, 0), path=photos[0], sha256="ab" * 32)
    record = write_record(tmp_path / "known.crf.json", photo, known, Settings())
    ended = CommandLine(capfd)("merge", *photos, "-o", tmp_path / "a.exr", "--curve", record)
    named = [line for line in ended.err.splitlines() if "disagrees with the others" in line]
    assert named
    assert all("--stops" in line for line in named)


@pytest.mark.slow
def test_the_table_of_merges_has_ghosts_for_peers_and_fewer_for_us():
    mine, theirs = (
        merge_errors.measured(one, 1)
        for one in (merge_errors.ours, merge_errors.opencv("Robertson"))
    )
    assert mine[0] < 1.1 * theirs[0]
    assert mine[4] < 0.3 * theirs[4]
