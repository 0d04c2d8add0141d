"""Brackets: found among other photos, and solved where that brings a curve near the truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from archive_photos import ONE, exposed, table, write_face, write_picture
from command_line import CommandLine

from facecrf_ocio.archive.cameras.bracket import BracketPhoto, find_brackets, stops_of
from facecrf_ocio.archive.cameras.camera_group import bracket_estimate, solve
from facecrf_ocio.joint.prior import shipped_prior
from facecrf_ocio.pair.bracket_curve import rmse_after_scale, solve_bracket
from facecrf_ocio.pair.code_samples import COLUMNS, ROWS, read_samples, take_samples
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.photo.shot import Shot, read_shot
from facecrf_ocio.record.calibration_record import read_record
from facecrf_ocio.response.model import dorf_model, inverse_crf, strictly_increasing
from facecrf_ocio.response.stops import stops_error, uniform
from facecrf_ocio.synthetic import encode, gamma_curve
from facecrf_ocio.values import InverseCRF, Verdict

GRAY_RAMP = np.geomspace(0.004, 1.0, ROWS * COLUMNS).reshape(ROWS, COLUMNS)


def scene():
    """(384, 512, 3) patches of one color each, over eight stops, in no order."""
    light = np.random.default_rng(2).permutation(GRAY_RAMP.ravel()).reshape(ROWS, COLUMNS)
    tint = np.array([1.0, 0.9, 0.8])
    return np.repeat(np.repeat(light[..., None] * tint, 16, axis=0), 16, axis=1).astype(np.float32)


def shoot(linear, curve, stops, noise=0.003):
    rng = np.random.default_rng(3)
    shots = []
    for stop in stops:
        light = linear * 2.0**stop
        light = light + rng.normal(0, noise, light.shape) * np.sqrt(light)
        shots.append(take_samples(encode(np.clip(light, 0, 1).astype(np.float32), curve)))
    return shots


def responses():
    """The fixed ones, and film and digital curves drawn from the prior that ships."""
    prior = shipped_prior()
    rng = np.random.default_rng(4)
    yield gamma_curve(2.2)
    yield inverse_crf(dorf_model().grid, [dorf_model().mean] * 3)
    for component in rng.choice(len(prior.weights), 6, p=prior.weights / prior.weights.sum()):
        drawn = rng.multivariate_normal(prior.means[component], prior.covariances[component])
        yield InverseCRF(
            np.linspace(0, 1, 4096),
            strictly_increasing(
                [np.interp(np.linspace(0, 1, 4096), prior.grid, prior.samples(drawn))] * 3
            ),
        )


@pytest.mark.parametrize(("stops", "least"), [((-2, -1, 0, 1, 2), 6), ((-2, 0, 2), 2)])
def test_a_curve_that_is_used_is_near_the_truth(stops, least):
    """In stops: where white lies is a guess for drawn curves that are steep beyond all points."""
    mean = inverse_crf(dorf_model().grid, [dorf_model().mean] * 3)
    used, errors, of_mean = 0, [], []
    for truth in responses():
        solved = solve_bracket([read_samples(s) for s in shoot(scene(), truth, stops)], stops)
        if not solved.problem:
            used += 1
            errors.append(stops_error(uniform(solved.found), uniform(truth)).mid)
            of_mean.append(stops_error(uniform(mean), uniform(truth)).mid)
    assert used >= least
    assert max(errors) < 0.05
    assert np.median(errors) < 0.03 < np.median(of_mean)


def gray(stops, truth=None):
    return [read_samples(s) for s in shoot(scene(), truth or gamma_curve(2.2), stops)]


def test_what_is_not_well_conditioned_is_not_used():
    even = (-2, 0, 2)
    assert not solve_bracket(gray(even), even).problem
    assert "stops, fewer" in solve_bracket(gray((0, 0.5)), (0, 0.5)).problem
    dark = [read_samples(s) for s in shoot(scene() * 0.02, gamma_curve(2.2), even)]
    assert "too few" in solve_bracket(dark, even).problem
    moved = [*gray(even)[:2], np.random.default_rng(0).permutation(gray(even)[2])]
    assert "do not agree with their exposures" in solve_bracket(moved, even).problem
    black = [np.zeros((ROWS * COLUMNS, 3), np.uint8)] * 3
    assert "too few points" in solve_bracket(black, even).problem


def exposures(stops, seconds=None, linear=None):
    samples = shoot(scene() if linear is None else linear, gamma_curve(2.2), stops)
    seconds = range(len(stops)) if seconds is None else seconds
    return [
        BracketPhoto(f"{n}", f"{n}", Shot("", 1e9 + second, 0.01 * 2.0**stop, 4.0, 100.0), sample)
        for n, (stop, second, sample) in enumerate(zip(stops, seconds, samples, strict=True))
    ]


def names(brackets):
    return [[one.name for one in bracket] for bracket in brackets]


def test_exposures_of_one_scene_within_seconds_are_a_bracket():
    assert names(find_brackets(exposures((-1, 0, 1)))) == [["0", "1", "2"]]
    two = exposures((-1, 0, 1, -1, 0, 1), seconds=(0, 1, 2, 3, 4, 5))
    assert names(find_brackets(two)) == [["0", "1", "2"], ["3", "4", "5"]]
    by_iso = [
        replace(one, shot=replace(one.shot, exposure_s=0.01, iso=100.0 * 2.0**stop))
        for one, stop in zip(exposures((-1, 0, 1)), (-1, 0, 1), strict=True)
    ]
    assert names(find_brackets(by_iso)) == [["0", "1", "2"]]


def test_a_bracket_may_take_minutes_and_come_in_any_order_with_other_photos_between():
    by_hand = exposures((2, -1, 0, 1, -2), seconds=(0, 40, 120, 200, 290))
    other = exposures((0.5,), seconds=(60,), linear=scene()[:, ::-1].copy())
    series = sorted([*by_hand, replace(other[0], name="other", sha256="other")], key=taken)
    assert names(find_brackets(series)) == [["0", "1", "2", "3", "4"]]


def taken(one):
    return one.shot.taken


def test_other_photos_are_no_bracket():
    assert names(find_brackets(exposures((0, 1), seconds=(0, 300)))) == []
    assert names(find_brackets(exposures((0, 0.1)))) == []
    first, second = exposures((0, 1))
    flipped = exposures((0, 1), linear=scene()[::-1].copy())[1]
    assert names(find_brackets([first, second])) == [["0", "1"]]
    assert names(find_brackets([first, flipped])) == []
    darker = replace(second, samples=exposures((0, -1))[1].samples)  # EXIF says brighter
    assert names(find_brackets([first, darker])) == []


def test_samples_are_the_code_values_at_the_centers_of_cells():
    pixels = np.zeros((ROWS * 8, COLUMNS * 8, 3), np.float32)
    pixels[4::8, 4::8] = 1.0
    found = read_samples(take_samples(pixels)).reshape(ROWS, COLUMNS, 3)
    assert (found == round(255 / 25)).all()  # one of the 25 pixels around each center


def test_exif_tells_exposure_time_and_picture_settings(tmp_path):
    said = {**exposed(7, 1.0), "Exif__SubsecTimeOriginal": "25", "Exif__Contrast": 2}
    shot = read_shot(write_picture(tmp_path / "a.jpg", scene(), **said))
    assert shot.exposure_s == pytest.approx(0.02, rel=1e-3)
    assert (shot.aperture, shot.iso) == (4.0, 100.0)
    assert shot.taken % 60 == 7.25
    assert shot.style == "Exif:Contrast=2"
    assert read_shot(write_picture(tmp_path / "b.png", scene())) == Shot()


@pytest.mark.slow
def test_the_photos_of_a_bracket_get_its_curve_and_tell_how_far_it_is_from_the_estimate(
    capfd, tmp_path
):
    source, output = tmp_path / "photos", tmp_path / "luts"
    write_face(source / "face.jpg", 1, **ONE)
    for number, stop in enumerate((-2, -1, 0, 1, 2)):
        light = scene() * np.float32(2.0**stop)
        write_picture(source / f"ramp{number}.jpg", light, **ONE, **exposed(number, stop))
    ended = CommandLine(capfd)(
        "batch", source, "-o", output, "--pool", "camera", "--formats", "spi1d", "--jobs", "2"
    )
    assert ended.code == 0, ended.err
    ((name, count, stops, used, rmse),) = table(
        output, "SELECT name, photos, stops, used, rmse FROM brackets"
    )
    assert (name, count, used) == ("ramp0.jpg", 5, 1)
    assert stops == pytest.approx(4.0, abs=0.01)
    told = read_record(output / "ramp3.jpg.crf.json").estimate
    camera = read_record(output / "face.jpg.crf.json").estimate
    assert (told.estimator, camera.estimator) == ("bracket", "joint")
    assert rmse_after_scale(told.curve, camera.curve) == pytest.approx(rmse, abs=1e-6)
    assert f"after one scale: {rmse:.3f}" in told.confidence.reasons[2]
    assert rmse_after_scale(told.curve, gamma_curve(2.2)) < 0.02


@pytest.mark.parametrize(("off", "verdict"), [(0.0, Verdict.RELIABLE), (0.5, Verdict.WEAK)])
def test_a_bracket_in_which_a_time_is_false_is_weak_and_names_its_photo(off, verdict):
    stops = np.arange(-3.0, 3.0)
    told_stops = stops + off * (stops == -1.0)
    members = tuple(
        replace(one, shot=replace(one.shot, exposure_s=2.0**stop / 64.0))
        for one, stop in zip(exposures(stops), told_stops, strict=True)
    )
    told = bracket_estimate(members, solve(members), None).confidence
    assert told.verdict is verdict
    assert [doubt.split(" was exposed")[0] for doubt in told.doubts] == ["2"] * bool(off)


def ordinary(folder, count):
    """A walk's photos: other things at other light, and each second one a step on from the last."""
    rng = np.random.default_rng(7)
    paths = sorted((folder / "faces" / "rendered" / "img").glob("*_noisy.exr"))
    curve, taken_at, found = gamma_curve(2.2), 0.0, []
    for number in range(count):
        picture = np.clip(read_photo(paths[number // 2 % len(paths)]).encoded, 0.0, None)
        height, width = picture.shape[:2]
        top, left = (int(rng.integers(0, size // 3)) for size in (height, width))
        part = picture[top : top + height // 2, left : left + width // 2]
        metered = 0.4 / max(float(np.quantile(part, 0.8)), 1e-3) * 2.0 ** rng.normal(0, 0.3)
        encoded = encode(np.clip(part * metered, 0, 1).astype(np.float32), curve)
        taken_at += float(rng.choice([1.5, 4.0, 20.0, 90.0]))
        time = 1.0 / float(rng.choice([60, 125, 250, 500]))
        shot = Shot(taken=taken_at, exposure_s=time, aperture=4.0, iso=100.0)
        found.append(BracketPhoto(str(number), str(number), shot, take_samples(encoded)))
    return found


@pytest.mark.slow
def test_no_bracket_is_invented_among_200_ordinary_photos(development_data):
    sets = list(find_brackets(ordinary(development_data, 200)))
    solved = [
        solve_bracket([read_samples(one.samples) for one in members], stops_of(members))
        for members in sets
    ]
    assert [names(sets)[k] for k, one in enumerate(solved) if not one.problem] == []
