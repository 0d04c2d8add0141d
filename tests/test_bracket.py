"""One bracket by hand: real stacks against curves found independently, and what stops it."""

from __future__ import annotations

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from archive_photos import exposed, write_picture
from command_line import CommandLine, write_noise

from facecrf_ocio.benchmark.peers.bracket_curves import Brackets
from facecrf_ocio.benchmark.peers.made_curves import made_curves
from facecrf_ocio.pair.bracket_curve import solve_bracket
from facecrf_ocio.pair.calibrate_bracket import bracket_doubts, bracket_verdict
from facecrf_ocio.record.calibration_record import read_record
from facecrf_ocio.response.expected_stops import expected_of_sigma, verdict_of
from facecrf_ocio.response.stops import stops_error, uniform
from facecrf_ocio.synthetic import encode, gamma_curve
from facecrf_ocio.values import Verdict

CODES = np.arange(32, 236) / 255.0


def points(stops, curve, seed=0):
    """(J, 600, 3) code values, with noise of half a code, of light over ten stops."""
    generator = np.random.default_rng(seed)
    light = np.exp2(generator.uniform(-9.0, 1.0, (600, 1))) * np.array([1.0, 0.9, 0.8])
    shots = [encode(np.clip(light * 2.0**s, 0, 1), curve) * 255.0 for s in stops]
    return [np.rint(s + generator.normal(0, 0.5, s.shape)).clip(0, 255) for s in shots]


def stops_off(found, truth_light, channel=1):
    """[stop] RMS over codes 32 to 235, after the one free factor."""
    mine = np.log2(np.interp(CODES, found.encoded, found.linear[channel]))
    return float(np.std(mine - np.log2(truth_light)))


def test_a_known_response_is_found_to_a_hundredth_of_a_stop():
    truth, stops = gamma_curve(2.2), (-3.0, -1.5, 0.0, 1.5)
    solved = solve_bracket(points(stops, truth), stops)
    assert solved.problem == ""
    assert stops_off(solved.found, np.interp(CODES, truth.encoded, truth.linear[1])) < 0.02
    assert solved.residual < 0.1


def test_an_exposure_that_is_off_its_grid_is_refined():
    truth, told = gamma_curve(2.2), (-3.0, -2.0, -1.0, 0.0, 1.0)
    real = (-3.0, -2.0, -0.92, 0.0, 1.0)
    solved = solve_bracket(points(real, truth), told)
    assert solved.refined[2] - told[2] > 0.05
    assert np.abs(np.delete(solved.refined - told, 2)).max() < 0.04


def test_photos_that_show_white_alone_leave_the_others_as_they_are():
    """They tell of no exposure. Where they stood in for all, the others shrank to nothing."""
    truth, stops = gamma_curve(2.2), (-2.0, -1.0, 0.0, 9.5, 10.0)
    shots = points(stops, truth)
    assert min(shots[-1].min(), shots[-2].min()) > 249
    solved = solve_bracket(shots, stops)
    assert np.abs(solved.refined - stops).max() < 0.01
    assert stops_off(solved.found, np.interp(CODES, truth.encoded, truth.linear[1])) < 0.02


def test_photos_between_which_others_are_missing_keep_their_steps():
    """A window in the first three, the room in the last, and glare in eight points of both."""
    truth, stops = gamma_curve(2.2), np.array([-10.0, -9.0, -8.0, 0.0, 1.0, 2.0])
    generator = np.random.default_rng(0)
    window = np.arange(600) < 200
    light = np.exp2(np.where(window, generator.uniform(2, 9, 600), generator.uniform(-8, 0, 600)))
    seen = np.exp2(stops)[:, None, None] * light[:, None] * np.array([1.0, 0.9, 0.8])
    shots = encode(np.clip(seen, 0.0, 1.0), truth) * 255.0
    shots = np.rint(shots + generator.normal(0.0, 0.5, shots.shape)).clip(0, 255)
    usable = np.where(np.arange(6)[:, None] < 3, window, ~window)
    shots[2, -8:], usable[2, -8:] = 5.0, True
    solved = solve_bracket(shots, stops, usable)
    assert np.abs(solved.refined - stops).max() < 0.02
    assert stops_off(solved.found, np.interp(CODES, truth.encoded, truth.linear[1])) < 0.02


def test_points_that_moved_are_set_aside():
    truth, stops = gamma_curve(2.2), (-3.0, -1.5, 0.0, 1.5)
    shots = points(stops, truth)
    shots[1][:90] = shots[1][:90][::-1]
    solved = solve_bracket(shots, stops)
    assert stops_off(solved.found, np.interp(CODES, truth.encoded, truth.linear[1])) < 0.03


def test_what_to_expect_of_it_is_of_its_shape():
    """Exposures that see no white leave its place open, which is one factor of all that is seen."""
    truth, stops = gamma_curve(2.2), (-5.0, -4.0, -3.0, -2.0)
    solved = solve_bracket(points(stops, truth), stops)
    assert solved.found is not None
    told = solved.in_stops
    assert told.mid < 0.5 * expected_of_sigma(solved.found, solved.sigma).mid
    error = stops_error(uniform(solved.found), uniform(truth))
    assert error.mid < 2.0 * told.mid < 0.2
    assert np.all(told.sigma[:, 128] == 0.0)
    assert np.all(told.sigma[:, 250] > told.sigma[:, 160])


def test_times_that_are_off_leave_the_slope_open_the_more_the_shorter_the_bracket():
    """Real ones were off by 0.1 stops over two, and 0.03 stops were told where 0.1 is likely."""
    truth, told = gamma_curve(2.2), []
    off = np.array([-0.17, -0.03, 0.13, 0.13, -0.04, -0.15])
    for step, departs in ((1.2, 0.0), (1.2, off), (0.4, off)):
        stops = step * np.arange(-6.0, 0.0)
        solved = solve_bracket(points(stops + departs, truth), stops)
        assert solved.in_stops is not None
        told.append(solved.in_stops)
    assert told[0].mid < 0.04
    assert told[0].shadows < told[1].shadows < 0.7 * told[2].shadows


def toned(stops, contrasts, curve, seed=0):
    """Points of photos each of which has an exponent of its own, as phones tone them."""
    generator = np.random.default_rng(seed)
    light = np.exp2(generator.uniform(-9.0, 1.0, (600, 1))) * np.array([1.0, 0.9, 0.8])
    shots = []
    for stop, contrast in zip(stops, contrasts, strict=True):
        seen = 0.2 * (np.clip(light * 2.0**stop, 0, 1) / 0.2) ** contrast
        shots.append(encode(np.clip(seen, 0, 1), curve) * 255.0)
    return [np.rint(s + generator.normal(0, 0.5, s.shape)).clip(0, 255) for s in shots]


def test_photos_that_are_toned_one_by_one_raise_what_is_expected():
    """Halves of the points share what is wrong with a photo, so they tell little of it."""
    truth, stops = gamma_curve(2.2), np.arange(-4.0, 2.0)
    steady = solve_bracket(toned(stops, np.ones(6), truth), stops)
    uneven = solve_bracket(toned(stops, (0.9, 1.1, 0.85, 1.15, 0.9, 1.1), truth), stops)
    assert steady.in_stops is not None
    assert uneven.in_stops is not None
    assert steady.in_stops.mid < 0.04
    assert uneven.in_stops.mid > 2.0 * steady.in_stops.mid
    assert uneven.in_stops.shadows > 2.0 * steady.in_stops.shadows


@pytest.mark.parametrize("off", [-2.0, -0.5, 1.0])
@pytest.mark.parametrize("photo", [0, 2, 5])
def test_the_photo_whose_time_is_false_is_found(photo, off):
    truth, told = gamma_curve(2.2), np.arange(-4.0, 2.0)
    real = told + off * (np.arange(6) == photo)
    false = solve_bracket(points(real, truth), told).false
    assert false is not None
    assert false[0] == photo
    assert abs(false[1] - off) < 0.1


def test_no_photo_is_named_where_times_are_true_or_where_three_tell_of_none():
    truth, told = gamma_curve(2.2), np.arange(-4.0, 2.0)
    uneven = told + np.array([0.1, -0.1, 0.1, -0.1, 0.1, -0.1])
    for real in (told, uneven):
        assert solve_bracket(points(real, truth), told).false is None
    assert solve_bracket(points((-4.0, -2.0, 1.0), truth), (-4.0, -2.0, 0.0)).false is None


@pytest.mark.parametrize("told", [(1.0, 0.0, -1.0, -2.0), (-2.0, 0.0, -1.0, 1.0)])
def test_exposures_out_of_order_or_with_exchanged_signs_give_no_curve(told):
    """By exchanged signs all points agree, with a curve that was called reliable."""
    shots = points((-2.0, -1.0, 0.0, 1.0), gamma_curve(2.2))
    assert "check the order and the signs" in solve_bracket(shots, told).problem


def test_of_two_photos_none_is_reliable_as_nothing_checks_their_exposures():
    truth = gamma_curve(2.2)
    two = solve_bracket(points((-3.0, 0.0), truth), (-3.0, 0.0))
    assert verdict_of(two.in_stops) is Verdict.RELIABLE
    assert bracket_verdict(two) is Verdict.WEAK
    assert "a third would check these" in " ".join(bracket_doubts(two, ["a.jpg", "b.jpg"]))
    three = solve_bracket(points((-3.0, -1.5, 0.0), truth), (-3.0, -1.5, 0.0))
    assert bracket_verdict(three) is Verdict.RELIABLE
    assert bracket_doubts(three, ["a.jpg", "b.jpg", "c.jpg"]) == ()


def false_bracket(folder, off):
    """Six photos a stop apart, of which 3.jpg tells a time that is off by so many stops."""
    linear = np.tile(np.geomspace(0.002, 1.0, 640, dtype=np.float32)[:, None], (400, 1, 3))
    told = np.arange(-4, 2) + off * (np.arange(6) == 3)
    return [
        write_picture(folder / f"{n}.jpg", linear * 2.0 ** (n - 4), **exposed(n, float(told[n])))
        for n in range(6)
    ]


@pytest.mark.parametrize("off", [2.0, -1.0])
def test_following_what_is_told_of_a_false_time_gives_a_reliable_curve(capfd, tmp_path, off):
    photos, command = false_bracket(tmp_path, off), CommandLine(capfd)
    ended = command("bracket", *photos, "-o", tmp_path / "out")
    said = ended.out + ended.err
    how = f"3.jpg was exposed {abs(off):.1f} stops {'less' if off > 0 else 'more'} than is told"
    assert said.count(how) == said.count("was exposed") == 1
    assert "run again without it, or with --stops 0," in said
    other = ("reliable", "tripod", "a longer bracket", "--fallback", "check the order")
    assert [words for words in other if words in said] == []
    told = said.partition("--stops ")[2].split()[0]
    assert np.allclose(np.array(told.split(","), float), np.arange(6), atol=0.1)
    for again in (photos[:3] + photos[4:], [*photos, "--stops", told]):
        ended = command("bracket", *again, "-o", tmp_path / str(len(again)))
        assert "calibrated (reliable)" in ended.out, ended.err


@pytest.mark.slow
def test_steps_of_two_stops_leave_no_waves():
    """Bends that are likely one by one, and together a wave of one step, were off by 0.038."""
    truth = made_curves()["sRGB, more contrast"]
    found = Brackets([truth]).ours(0)
    assert found is not None
    assert stops_error(uniform(found), uniform(truth)).mid < 0.025


@pytest.mark.parametrize("warm", [0.5, 0.6])
def test_channels_that_are_alike_go_on_alike_where_light_is_warm(warm):
    truth = made_curves()["sRGB after a shoulder"]
    generator, stops = np.random.default_rng(2), np.array([-4.0, -2.0, 0.0, 2.0])
    light = np.exp2(generator.uniform(-9.0, 2.0, (1500, 1)) + generator.normal(0, 0.3, (1500, 3)))
    light *= (1.5, 1.0, warm)
    shots = [encode(np.clip(light * 2.0**stop, 0, 1), truth) * 255.0 for stop in stops]
    shots = [np.rint(s + generator.normal(0, 0.4, s.shape)).clip(0, 255) for s in shots]
    found = solve_bracket(shots, stops).found
    gray = np.array([np.interp(0.5, found.encoded, row) for row in found.linear])
    assert np.abs(np.log2(gray / gray[1])).max() < 0.03


@pytest.mark.slow
def test_a_real_stack_gives_the_curve_found_independently(capfd, tmp_path, development_data):
    stack = development_data / "stacks" / "canon_5d_corridor"
    stored = development_data / "crf" / "modern_stacks.npz"
    if not stored.exists() or not stack.exists():
        pytest.skip("the stacks are not beside the checkout")
    photos = sorted(stack.glob("*.jpg"))[::2]
    ended = CommandLine(capfd)("bracket", *photos, "-o", tmp_path, "--formats", "spi1d")
    assert ended.code == 0, ended.err
    told = read_record(tmp_path / f"{photos[0].name}.crf.json").estimate
    with np.load(stored) as curves:
        place = list(curves["names"]).index("Canon EOS 5D (exposure stacks)")
        truth = np.interp(CODES, np.linspace(0, 1, 1024), curves["inverse"][place, 1])
    assert stops_off(told.curve, truth) < 0.06


class TestBadInput:
    def picture(self, path, size, **said):
        linear = np.tile(np.linspace(0.01, 0.9, size, dtype=np.float32)[None, :, None], (40, 1, 3))
        return write_picture(path, linear, **said)

    def test_one_photo(self, capfd, tmp_path):
        one = self.picture(tmp_path / "a.jpg", 60, **exposed(0, 0.0))
        ended = CommandLine(capfd)("bracket", one, "-o", tmp_path / "out")
        assert ended.code == 3
        assert "is one photo, and no bracket" in ended.err

    def test_one_photo_that_tells_no_time_is_still_but_one(self, capfd, tmp_path):
        one = self.picture(tmp_path / "a.jpg", 60)
        for command, out in (("bracket", "out"), ("merge", "out.exr")):
            ended = CommandLine(capfd)(command, one, "-o", tmp_path / out)
            assert ended.code == 3
            assert "is one photo, and no bracket" in ended.err

    def test_mixed_sizes(self, capfd, tmp_path):
        photos = [
            self.picture(tmp_path / f"{n}.jpg", 60 + 8 * n, **exposed(n, n)) for n in range(2)
        ]
        ended = CommandLine(capfd)("bracket", *photos, "-o", tmp_path / "out")
        assert ended.code == 3
        assert "has 68 x 40 pixels, the photos before it 60 x 40" in ended.err

    def test_no_exposure_told(self, capfd, tmp_path):
        photos = [self.picture(tmp_path / f"{n}.jpg", 60) for n in range(2)]
        ended = CommandLine(capfd)("bracket", *photos, "-o", tmp_path / "out")
        assert ended.code == 3
        assert "does not tell its exposure time; give the exposures, --stops" in ended.err

    def test_all_alike(self, capfd, tmp_path):
        photos = [self.picture(tmp_path / f"{n}.jpg", 200) for n in range(2)]
        ended = CommandLine(capfd)("bracket", *photos, "--stops", "0,0.2", "-o", tmp_path / "out")
        assert ended.code == 4
        assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("command", [("bracket", "out"), ("merge", "out.exr")])
def test_a_photo_that_is_missing_or_a_folder_is_told_in_words(capfd, tmp_path, command):
    name, output = command
    photos = (tmp_path / "a.jpg", tmp_path)
    for photo, said in zip(photos, ("does not exist", "is a folder"), strict=True):
        ended = CommandLine(capfd)(name, photo, "-o", tmp_path / output)
        assert ended.code == 3
        assert said in ended.err
        assert len(ended.err.splitlines()) == 1
    assert not (tmp_path / output).exists()


def test_a_text_named_as_a_photo_is_told_as_no_image(capfd, tmp_path):
    photos = [tmp_path / f"{n}.jpg" for n in range(2)]
    for photo in photos:
        photo.write_text("no light here")
    ended = CommandLine(capfd)("bracket", *photos, "-o", tmp_path / "out")
    assert ended.code == 3
    assert "0.jpg: is not an image that can be read" in ended.err


@pytest.mark.parametrize("given", ["nan,0", "0,inf", "0,1e308", "-65,0", "0"])
def test_stops_of_no_camera_are_wrong_usage(facecrf: CommandLine, tmp_path, given: str) -> None:
    photos = [write_noise(tmp_path / f"{name}.png") for name in "ab"]
    ended = facecrf("bracket", *photos, "-o", tmp_path / "out", f"--stops={given}")
    assert ended.code == 2
    assert ended.err.startswith("facecrf: --stops ")
    assert ended.err.count("\n") == 1


@pytest.mark.parametrize("command", ["bracket", "merge", "pair", "cameras measure"])
def test_what_openimageio_said_of_a_file_is_not_left_for_its_own_words_at_exit(
    capfd, tmp_path, command
):
    """It prints what nobody asked for on stdout, three lines, among JSON too."""
    photos = [tmp_path / name for name in ("a.rw2", "b.rw2")]
    for photo in photos:
        photo.write_bytes(b"IIU\0" + bytes(400))
    given = photos[: 1 if command == "pair" else 2]
    out = tmp_path / ("out.exr" if command == "merge" else "out")
    output = () if command == "cameras measure" else ("-o", out)
    ended = CommandLine(capfd)(*command.split(), *given, *output)
    assert ended.code in {3, 4}
    assert oiio.geterror() == ""
