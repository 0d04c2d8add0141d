"""The commands: what they write, print and return."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import click
import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from command_line import CODE, CommandLine, names_in, write_noise
from face_photos import grace_hopper
from photo_files import (
    matrix_profile,
    oiiotool,
    pixels_of,
    random_codes,
    write,
    write_dng,
    write_spi1d,
)
from PIL import Image

from facecrf_ocio import __version__, read_photo
from facecrf_ocio.cli.facecrf import main
from facecrf_ocio.cli.sections import EXAMPLES, SECTIONS
from facecrf_ocio.color.primaries import KNOWN_PRIMARIES
from facecrf_ocio.color.working_space import WORKING_SPACES, working_space_matrix
from facecrf_ocio.errors import OutputError
from facecrf_ocio.files import atomic, versions
from facecrf_ocio.files.atomic import Draft
from facecrf_ocio.image.compression import COMPRESSIONS
from facecrf_ocio.record.calibration_record import read_record

DONE, FAILED, USAGE, UNREADABLE, NOTHING = range(5)
ALL = {"a.png.spi1d", "a.png.cube", "a.png.clf", "a.png.crf.json"}
BLIND = ("--estimator", "srgb")  # needs no face, so a photo of noise will do


@pytest.fixture
def photo(tmp_path: Path) -> Path:
    return write_noise(tmp_path / "a.png")


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "out"


def srgb_decoding(code: Any) -> Any:
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


class TestHelp:
    def test_imports_nothing_heavy(self) -> None:
        heavy = {
            *("numpy", "scipy", "cv2", "matplotlib", "PIL", "rich"),
            *("OpenImageIO", "PyOpenColorIO", "rawpy"),
        }
        code = (
            "import sys\nfrom facecrf_ocio.cli.facecrf import main\n"
            "main(['--help'], standalone_mode=False)\n"
            f"print('LOADED', *({heavy!r} & set(sys.modules)))"
        )
        ended = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
        assert ended.stdout.decode().splitlines()[-1] == "LOADED"

    def test_tells_commands_and_exit_codes(self, facecrf: CommandLine) -> None:
        ended = facecrf("--help")
        assert ended.code == DONE
        for word in ("calibrate", "linearize", "apply", "demo", "Exit codes"):
            assert word in ended.out

    def test_lists_each_command_once_with_its_whole_first_sentence(
        self, facecrf: CommandLine
    ) -> None:
        listed = [name for names in SECTIONS.values() for name in names]
        assert sorted(listed) == sorted(main.commands)
        told = facecrf("--help").out
        assert "..." not in told.split("Options:")[1]
        assert max(map(len, told.splitlines())) <= 80

    @pytest.mark.parametrize("group", ["bench", "cameras"])
    def test_of_a_group_tells_each_command_in_a_whole_sentence(
        self, facecrf: CommandLine, group: str
    ) -> None:
        told = facecrf(group, "--help").out
        assert "..." not in told.partition("Commands:")[2]
        assert all(f"  {name} " in told for name in main.commands[group].commands)

    @pytest.mark.parametrize("columns", [60, 80])
    @pytest.mark.parametrize("name", [name for names in SECTIONS.values() for name in names])
    def test_fits_the_terminal_except_for_commands_to_be_copied(
        self, facecrf: CommandLine, monkeypatch: pytest.MonkeyPatch, name: str, columns: int
    ) -> None:
        monkeypatch.setenv("COLUMNS", str(columns))
        told = facecrf(name, "--help").out.splitlines()
        wide = [line for line in told if len(line) > columns]
        assert [line for line in wide if " facecrf " not in line] == []

    def test_says_of_every_option_what_it_does(self) -> None:
        commands = dict(main.commands)
        for name in ("bench", "cameras"):
            commands |= {f"{name} {one}": c for one, c in main.commands[name].commands.items()}
        silent = [
            f"{name} {option.opts[-1]}"
            for name, command in commands.items()
            for option in command.params
            if isinstance(option, click.Option) and not option.help
        ]
        # Where a command writes to, its own sentence and the option's value say.
        assert [one for one in silent if not one.endswith(" --output")] == []

    @pytest.mark.parametrize("line", [line for lines in EXAMPLES.values() for line in lines])
    def test_examples_are_right_usage(self, line: str) -> None:
        _, name, *arguments = shlex.split(line)
        command = main.commands[name]
        command.make_parser(click.Context(command)).parse_args(list(arguments))
        assert main.commands[name].epilog is not None
        if isinstance(command, click.Group):
            assert arguments[0] in command.commands

    def test_of_a_command_ends_with_examples(self, facecrf: CommandLine) -> None:
        assert "Examples:\n    facecrf lint luts/a.jpg.cube" in facecrf("lint", "--help").out

    def test_version(self, facecrf: CommandLine) -> None:
        assert __version__ in facecrf("--version").out


class TestCalibrate:
    @pytest.mark.parametrize("name", ["a.cube", "a.png.clf", "a.ICC"])
    def test_a_file_is_no_folder_to_write_to(
        self, facecrf: CommandLine, photo: Path, tmp_path: Path, name: str
    ) -> None:
        ended = facecrf("calibrate", photo, "-o", tmp_path / name, *BLIND)
        assert ended.code == USAGE
        assert f"{name} names a file; name the folder that gets the files" in ended.err
        assert not (tmp_path / name).exists()
        (tmp_path / name).mkdir()
        assert facecrf("calibrate", photo, "-o", tmp_path / name, *BLIND).code == DONE

    def test_writes_luts_and_record_and_names_them(
        self, facecrf: CommandLine, photo: Path, out: Path
    ) -> None:
        ended = facecrf("calibrate", photo, "-o", out, *BLIND)
        assert (ended.code, ended.err) == (DONE, "")
        assert names_in(out) == ALL
        first, *files = ended.out.splitlines()
        assert first.startswith(f"{photo}: fallback (prior only): ")
        assert {Path(line.strip()) for line in files} == {out / name for name in ALL}
        curve = read_record(out / "a.png.crf.json").estimate.found
        assert curve is not None
        assert np.allclose(curve.linear, srgb_decoding(curve.encoded), atol=1e-6)

    def test_nothing_is_written_where_more_error_is_expected_than_asked_for(
        self, facecrf: CommandLine, photo: Path, out: Path
    ) -> None:
        ended = facecrf("calibrate", photo, "-o", out, "--max-error", "0.05", *BLIND)
        assert ended.code == NOTHING
        assert "above the 0.05 stops asked for" in ended.err
        assert names_in(out) == set()
        assert facecrf("calibrate", photo, "-o", out, "--max-error", "2", *BLIND).code == DONE

    def test_only_the_formats_asked_for(self, facecrf: CommandLine, photo: Path, out: Path) -> None:
        assert facecrf("calibrate", photo, "-o", out, "--formats", "CUBE, clf", *BLIND).code == DONE
        assert names_in(out) == {"a.png.cube", "a.png.clf", "a.png.crf.json"}

    @pytest.mark.parametrize("formats", ["tiff", "cube,tiff", "", " , "])
    def test_unknown_formats(
        self, facecrf: CommandLine, photo: Path, out: Path, formats: str
    ) -> None:
        ended = facecrf("calibrate", photo, "-o", out, "--formats", formats, *BLIND)
        assert ended.code == USAGE
        assert "spi1d, cube, clf" in ended.err.splitlines()[-1]
        assert names_in(out) == set()

    @pytest.mark.parametrize(
        "wrong", [("--estimator", "magic"), ("--fallback", "magic"), ("--magic",)]
    )
    def test_wrong_usage(
        self, facecrf: CommandLine, photo: Path, out: Path, wrong: tuple[str, ...]
    ) -> None:
        ended = facecrf("calibrate", photo, "-o", out, *wrong)
        assert ended.code == USAGE
        assert wrong[-1] in ended.err.splitlines()[-1]
        assert names_in(out) == set()

    def test_no_photo_or_no_folder(self, facecrf: CommandLine, photo: Path, out: Path) -> None:
        assert facecrf("calibrate", "-o", out).code == USAGE
        assert facecrf("calibrate", photo).code == USAGE

    @pytest.mark.parametrize("name", ["mean", "srgb", "gamma22", "identity"])
    def test_fixed_estimators_say_that_they_are(
        self, facecrf: CommandLine, photo: Path, out: Path, name: str
    ) -> None:
        ended = facecrf("calibrate", photo, "-o", out, "--estimator", name)
        assert ended.code == DONE
        assert "fallback" in ended.out
        assert read_record(out / "a.png.crf.json").estimate.estimator == name

    @pytest.mark.parametrize(("name", "code"), [("none", NOTHING), ("mean", DONE), ("srgb", DONE)])
    def test_fallback_without_a_face(
        self, facecrf: CommandLine, photo: Path, out: Path, name: str, code: int
    ) -> None:
        ended = facecrf("calibrate", photo, "-o", out, "--fallback", name)
        assert ended.code == code
        assert names_in(out) == (ALL if code == DONE else set())
        if code == DONE:
            assert f"no face found: fell back to the {name} curve" in ended.out

    def test_json_is_one_object_per_line(
        self, facecrf: CommandLine, photo: Path, tmp_path: Path, out: Path
    ) -> None:
        broken = tmp_path / "b.png"
        broken.write_bytes(photo.read_bytes()[:-20])
        linear = write(tmp_path / "c.exr", np.full((4, 4, 3), 0.5, "f"), oiio.HALF)
        ended = facecrf("calibrate", photo, broken, linear, "-o", out, "--json")
        records = [json.loads(line) for line in ended.out.splitlines()]
        assert [record["photo"] for record in records] == [str(photo), str(broken), str(linear)]
        assert [record["exit_code"] for record in records] == [NOTHING, UNREADABLE, DONE]
        outcomes = ["not calibrated", "error", "already linear"]
        assert [record["outcome"] for record in records] == outcomes
        assert all(record["reason"] for record in records)
        assert {Path(file).name for file in records[2]["files"]} == {
            f"c.exr.{ending}" for ending in ("spi1d", "cube", "clf", "crf.json")
        }
        assert len(ended.err.splitlines()) == 2

    def test_plot_is_a_png(self, facecrf: CommandLine, photo: Path, out: Path) -> None:
        assert facecrf("calibrate", photo, "-o", out, "--plot", *BLIND).code == DONE
        assert names_in(out) == ALL | {"a.png.crf.png"}
        with Image.open(out / "a.png.crf.png") as picture:
            assert picture.format == "PNG"

    @pytest.mark.slow
    def test_what_matplotlib_logs_stays_off_the_terminal(self, photo: Path, out: Path) -> None:
        """Of a cache folder that it cannot have, and of fonts that it looks for in a new one."""
        command = [sys.executable, "-c", CODE, "calibrate", photo, "-o", out, "--plot", *BLIND]
        environment = {**os.environ, "MPLCONFIGDIR": str(photo / "none")}
        ended = subprocess.run(command, env=environment, capture_output=True, check=True)
        assert ended.stderr == b""

    def test_plot_beside_a_png_photo_leaves_it_alone(
        self, facecrf: CommandLine, photo: Path, tmp_path: Path
    ) -> None:
        before = photo.read_bytes()
        ended = facecrf("calibrate", photo, "-o", tmp_path, "--plot", "--overwrite", *BLIND)
        assert ended.code == DONE
        assert photo.read_bytes() == before

    @pytest.mark.slow
    def test_shared_curve(self, facecrf: CommandLine, tmp_path: Path, out: Path) -> None:
        codes = np.rint(255 * grace_hopper()).astype(np.uint8)
        Image.fromarray(codes).save(tmp_path / "a.png")
        for option in ("--shared", "--per-channel"):
            command = ("calibrate", tmp_path / "a.png", "-o", out, "--overwrite", option)
            ended = facecrf(*command, "--estimator", "face-unshaded")
            assert (ended.code, ended.err) == (DONE, "")
            curve = read_record(out / "a.png.crf.json").estimate.found
            assert curve is not None
            assert (curve.linear == curve.linear[0]).all() == (option == "--shared")


class TestSeveralPhotos:
    def test_one_bad_photo_does_not_keep_the_others(
        self, facecrf: CommandLine, tmp_path: Path, out: Path
    ) -> None:
        names = ("a.png", "b.png", "c.png")
        photos = [write_noise(tmp_path / name, seed=seed) for seed, name in enumerate(names)]
        photos[1].write_bytes(photos[1].read_bytes()[:100])
        ended = facecrf("calibrate", *photos, "-o", out, "--formats", "cube", *BLIND)
        assert ended.code == UNREADABLE
        assert names_in(out) == {
            f"{name}.{end}" for name in ("a.png", "c.png") for end in ("cube", "crf.json")
        }
        assert len(ended.err.splitlines()) == 1
        assert str(photos[1]) in ended.err

    def test_the_exit_code_is_the_worst(
        self, facecrf: CommandLine, photo: Path, tmp_path: Path, out: Path
    ) -> None:
        missing, taken = tmp_path / "missing.png", write_noise(tmp_path / "taken.png")
        linear = write(tmp_path / "l.exr", np.full((4, 4, 3), 0.5, "f"), oiio.HALF)
        command = ("calibrate", "-o", out, "--overwrite")
        assert facecrf(*command, linear).code == DONE
        assert facecrf(*command, linear, photo).code == NOTHING
        assert facecrf(*command, photo, missing, linear).code == UNREADABLE
        (out / "taken.png.cube").mkdir()
        assert facecrf(*command, photo, missing, taken, linear).code == FAILED

    def test_two_of_one_name(self, facecrf: CommandLine, photo: Path, out: Path) -> None:
        other = photo.parent / "b" / photo.name
        ended = facecrf("calibrate", photo, other, "-o", out, *BLIND)
        assert ended.code == USAGE
        assert ended.err.count("\n") == 1
        assert "would write the same files" in ended.err
        assert names_in(out) == set()

    def test_a_photo_named_twice_is_calibrated_once(
        self, facecrf: CommandLine, photo: Path, out: Path
    ) -> None:
        ended = facecrf("calibrate", photo, photo, "-o", out, "--json", *BLIND)
        assert ended.code == DONE
        assert len(ended.out.splitlines()) == 1


class TestExistingFiles:
    @pytest.mark.parametrize("name", [*sorted(ALL), "a.png.crf.png"])
    def test_are_kept(self, facecrf: CommandLine, photo: Path, out: Path, name: str) -> None:
        out.mkdir()
        (out / name).write_text("mine")
        ended = facecrf("calibrate", photo, "-o", out, "--plot", *BLIND)
        assert ended.code == FAILED
        told = f"facecrf: {out / name}: exists already; pass --overwrite to replace it\n"
        assert ended.err == told
        assert names_in(out) == {name}
        assert (out / name).read_text() == "mine"

    def test_are_replaced_on_demand(self, facecrf: CommandLine, photo: Path, out: Path) -> None:
        out.mkdir()
        for name in (*ALL, "a.png.crf.png"):
            (out / name).write_text("mine")
        ended = facecrf("calibrate", photo, "-o", out, "--plot", "--overwrite", *BLIND)
        assert ended.code == DONE
        assert names_in(out) == {*ALL, "a.png.crf.png"}
        assert all((out / name).read_bytes() != b"mine" for name in names_in(out))

    def test_a_plot_that_fails_takes_the_luts_with_it(
        self, facecrf: CommandLine, photo: Path, out: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def refuse(path: Path) -> None:
            raise OutputError("a.png.crf.png: the disk is full; free some space")

        monkeypatch.setattr(
            "facecrf_ocio.plots.calibration_plot.plot_draft",
            lambda path, *_: Draft(path, b"PNG", refuse),
        )
        ended = facecrf("calibrate", photo, "-o", out, "--plot", *BLIND)
        assert (ended.code, ended.out) == (FAILED, "")
        assert names_in(out) == set()


class TestOutputFolder:
    def test_is_made_with_those_above_it(
        self, facecrf: CommandLine, photo: Path, tmp_path: Path
    ) -> None:
        assert facecrf("calibrate", photo, "-o", tmp_path / "b" / "c", *BLIND).code == DONE
        assert names_in(tmp_path / "b" / "c") == ALL

    @pytest.mark.parametrize("below", ["", "below"])
    def test_is_a_file(self, facecrf: CommandLine, photo: Path, tmp_path: Path, below: str) -> None:
        (tmp_path / "taken").write_text("mine")
        target = tmp_path / "taken" / below
        ended = facecrf("calibrate", photo, photo.with_name("b.png"), "-o", target, *BLIND)
        assert ended.code == FAILED
        assert "is not a folder; choose another" in ended.err
        assert ended.err.count("\n") == 1
        assert (tmp_path / "taken").read_text() == "mine"

    @pytest.mark.parametrize("command", ["calibrate", "linearize"])
    def test_may_not_be_written_to(
        self,
        facecrf: CommandLine,
        photo: Path,
        tmp_path: Path,
        monkeypatch: pytest.MonkeyPatch,
        command: str,
    ) -> None:
        monkeypatch.setattr(os, "access", lambda *_: False)  # file modes do not stop root
        target = tmp_path if command == "calibrate" else tmp_path / "a.exr"
        ended = facecrf(command, photo, "-o", target, *BLIND)
        assert ended.code == FAILED
        assert "permission denied" in ended.err
        assert "choose a folder you may write to" in ended.err
        assert names_in(tmp_path) == {photo.name}


class TestScenelinearPhotos:
    @pytest.mark.parametrize("command", ["calibrate", "linearize"])
    @pytest.mark.parametrize("name", ["a.exr", "a.dng"])
    def test_the_answer_is_the_identity(
        self, facecrf: CommandLine, tmp_path: Path, out: Path, name: str, command: str
    ) -> None:
        path = tmp_path / name
        if name == "a.exr":
            write(path, np.random.default_rng(3).random((8, 9, 3), "f") * 4, oiio.FLOAT)
        else:
            write_dng(path, np.linspace(0, 60000, 32 * 32).reshape(32, 32))
        target = out if command == "calibrate" else tmp_path / "linear.exr"
        ended = facecrf(command, path, "-o", target)
        assert (ended.code, ended.err) == (DONE, "")
        assert "already linear" in ended.out
        if command == "calibrate":
            curve = read_record(out / f"{name}.crf.json").estimate.found
            assert curve is not None
            assert np.array_equal(curve.linear, np.tile(curve.encoded, (3, 1)))
        else:
            half = read_photo(path).encoded.astype(np.float16).astype(np.float32)
            assert np.array_equal(pixels_of(target), half)


class TestLinearize:
    def test_equals_oiiotool_with_the_lut_of_calibrate(
        self, facecrf: CommandLine, photo: Path, tmp_path: Path, out: Path
    ) -> None:
        exr = tmp_path / "a.exr"
        ended = facecrf("linearize", photo, "-o", exr, "--fallback", "mean")
        assert (ended.code, ended.err) == (DONE, "")
        assert ended.out.splitlines()[-1] == f"  {exr}"
        assert facecrf("calibrate", photo, "-o", out, "--fallback", "mean").code == DONE
        for name in sorted(ALL - {"a.png.crf.json"}):
            expected = oiiotool(photo, out / name, tmp_path / f"{name}.exr")
            assert np.allclose(pixels_of(exr), expected, rtol=2**-10, atol=2**-24)

    def test_says_what_it_is_and_where_from(
        self, facecrf: CommandLine, photo: Path, tmp_path: Path
    ) -> None:
        exr = tmp_path / "a.exr"
        assert facecrf("linearize", photo, "-o", exr, *BLIND).code == DONE
        header = oiio.ImageBuf(str(exr)).spec()
        assert header.get_string_attribute("colorInteropID") == "unknown"
        assert header.get_string_attribute("oiio:ColorSpace") == "unknown"
        said = {
            name: header.get_string_attribute(f"facecrf:{name}")
            for name in ("outcome", "estimator", "confidence", "version", "primaries")
        }
        assert said == {
            "outcome": "fallback",
            "estimator": "srgb",
            "confidence": "prior only",
            "version": __version__,
            "primaries": "unknown",
        }

    @pytest.mark.parametrize(
        ("space", "interop"),
        [
            ("acescg", "lin_ap1_scene"),
            ("lin_p3d65", "lin_p3d65_scene"),
            ("lin_rec709", "lin_rec709_scene"),
            ("aces2065-1", "lin_ap0_scene"),
        ],
    )
    @pytest.mark.parametrize("form", ["--half", "--float"])
    def test_goes_on_to_a_working_space_and_says_so(
        self, facecrf: CommandLine, tmp_path: Path, out: Path, form: str, space: str, interop: str
    ) -> None:
        photo, exr = tmp_path / "a.png", tmp_path / "a.exr"
        icc = matrix_profile(*KNOWN_PRIMARIES["Adobe RGB"])
        Image.fromarray(random_codes()).save(photo, icc_profile=icc)
        options = ("--to", space, *BLIND)
        assert facecrf("linearize", photo, "-o", exr, form, *options).code == DONE
        command = ("calibrate", photo, "-o", out, "--formats", "clf", *options)
        assert facecrf(*command).code == DONE
        expected = oiiotool(photo, out / f"a.png.{space}.clf", tmp_path / "b.exr")
        rounding = 2**-10 if form == "--half" else 1e-5
        assert np.allclose(pixels_of(exr), expected, rtol=rounding, atol=1e-6)
        header = oiio.ImageBuf(str(exr)).spec()
        assert header.get_string_attribute("colorInteropID") == interop
        assert header.get_string_attribute("oiio:ColorSpace") == interop
        xy = np.array(header.getattribute("chromaticities")).reshape(4, 2)
        assert np.allclose(xy, WORKING_SPACES[space])
        said = header.get_string_attribute("facecrf:primaries")
        assert said.endswith("by conversion from Adobe RGB")

    def test_a_working_space_keeps_alpha(self, facecrf: CommandLine, tmp_path: Path) -> None:
        photo, plain, exr = tmp_path / "a.png", tmp_path / "a.exr", tmp_path / "b.exr"
        codes = np.random.default_rng(0).integers(1, 256, (9, 7, 4), np.uint8)
        Image.fromarray(codes).save(photo)
        assert facecrf("linearize", photo, "-o", plain, "--float", *BLIND).code == DONE
        options = ("--float", "--to", "acescg", *BLIND)
        assert facecrf("linearize", photo, "-o", exr, *options).code == DONE
        before, after = pixels_of(plain), pixels_of(exr)
        matrix = working_space_matrix(None, "acescg")
        assert np.array_equal(after[..., 3], before[..., 3])
        assert np.allclose(after[..., :3], before[..., :3] @ matrix.T, rtol=0, atol=1e-6)

    @pytest.mark.parametrize(("option", "kind"), [("--half", oiio.HALF), ("--float", oiio.FLOAT)])
    def test_half_or_float(
        self, facecrf: CommandLine, photo: Path, tmp_path: Path, option: str, kind: Any
    ) -> None:
        exr = tmp_path / "a.exr"
        assert facecrf("linearize", photo, "-o", exr, option, *BLIND).code == DONE
        assert oiio.ImageBuf(str(exr)).spec().format.basetype == kind
        if kind == oiio.FLOAT:
            expected = srgb_decoding(read_photo(photo).encoded.astype(np.float64))
            assert np.allclose(pixels_of(exr), expected, atol=1e-6)

    @pytest.mark.parametrize(
        ("brightest", "options", "told", "kept"),
        [
            (1e5, (), True, 65504.0),
            (1e5, ("--float",), False, 1e5),
            (1e5, ("--exposure", "-1"), False, 5e4),
            (4e4, ("--exposure", "1"), True, 65504.0),
            (6e4, (), False, 6e4),
        ],
    )
    def test_light_beyond_half_floats_is_told(
        self,
        facecrf: CommandLine,
        tmp_path: Path,
        brightest: float,
        options: tuple[str, ...],
        told: bool,
        kept: float,
    ) -> None:
        light = np.full((8, 9, 3), 0.5, np.float32)
        light[3, 4] = brightest
        photo = write(tmp_path / "a.exr", light, oiio.FLOAT)
        ended = facecrf("linearize", photo, "-o", tmp_path / "b.exr", *options)
        assert ended.code == DONE
        assert ("note: light above 65504" in ended.out + ended.err) == told
        assert pixels_of(tmp_path / "b.exr").max() == pytest.approx(kept, rel=1e-3)

    @pytest.mark.parametrize("name", COMPRESSIONS)
    def test_compressions_are_openexrs(
        self, facecrf: CommandLine, photo: Path, tmp_path: Path, name: str
    ) -> None:
        exr = tmp_path / "a.exr"
        assert facecrf("linearize", photo, "-o", exr, "--compression", name, *BLIND).code == DONE
        assert oiio.ImageBuf(str(exr)).spec().get_string_attribute("compression") == name

    @pytest.mark.parametrize(
        ("target", "options", "code", "problem"),
        [
            ("a.exr", ("--compression", "magic"), USAGE, "'magic' is not one of"),
            ("a.exr", ("--compression", "piz:1"), USAGE, "piz has no levels; leave out ':1'"),
            ("a.exr", ("--compression", "zip:0"), USAGE, "give a level from 1 to 9"),
            ("a.exr", ("--compression", "zip:"), USAGE, "give a level from 1 to 9"),
            ("a.tif", (), FAILED, "is no name of an EXR; let it end in .exr"),
            ("missing/a.exr", (), FAILED, "create the folder first"),
            ("taken.exr", (), FAILED, "exists already; pass --overwrite to replace it"),
            ("folder.exr", ("--overwrite",), FAILED, "is not a regular file"),
            ("taken.exr/a.exr", (), FAILED, "taken.exr"),
        ],
    )
    def test_refusals(
        self,
        facecrf: CommandLine,
        photo: Path,
        tmp_path: Path,
        target: str,
        options: tuple[str, ...],
        code: int,
        problem: str,
    ) -> None:
        (tmp_path / "taken.exr").write_text("mine")
        (tmp_path / "folder.exr").mkdir()
        lut = write_spi1d(tmp_path / "a.spi1d")
        before = names_in(tmp_path)
        for command in (("linearize", *BLIND), ("apply", "--lut", lut)):
            ended = facecrf(*command, photo, "-o", tmp_path / target, *options)
            assert (ended.code, ended.out) == (code, "")
            assert problem in ended.err.splitlines()[-1]
            assert code == USAGE or ended.err.count("\n") == 1
        assert names_in(tmp_path) == before
        assert (tmp_path / "taken.exr").read_text() == "mine"

    def test_the_photo_itself_is_never_replaced(self, facecrf: CommandLine, tmp_path: Path) -> None:
        path = write(tmp_path / "a.exr", np.full((4, 4, 3), 0.5, "f"), oiio.HALF)
        before = path.read_bytes()
        ended = facecrf("linearize", path, "-o", path, "--overwrite")
        assert ended.code == FAILED
        assert "is the photo itself" in ended.err
        assert path.read_bytes() == before


class TestApply:
    def test_equals_oiiotool(self, facecrf: CommandLine, tmp_path: Path) -> None:
        photo = write(tmp_path / "a.tif", random_codes(dtype=np.uint16), oiio.UINT16)
        lut, exr = write_spi1d(tmp_path / "b.spi1d"), tmp_path / "a.exr"
        ended = facecrf("apply", photo, "--lut", lut, "-o", exr)
        assert (ended.code, ended.err) == (DONE, "")
        assert ended.out.splitlines()[-1] == f"  {exr}"
        expected = oiiotool(photo, lut, tmp_path / "expected.exr")
        assert np.allclose(pixels_of(exr), expected, rtol=2**-10, atol=2**-24)
        header = oiio.ImageBuf(str(exr)).spec()
        assert header.get_string_attribute("facecrf:lut") == "b.spi1d"
        assert header.get_string_attribute("colorInteropID") == "unknown"

    @pytest.mark.parametrize(("way", "told"), [("linearize", True), ("encode", False)])
    def test_light_that_is_sent_toward_light_is_told(
        self, facecrf: CommandLine, tmp_path: Path, way: str, *, told: bool
    ) -> None:
        photo = write(tmp_path / "a.exr", np.full((8, 8, 3), 0.5, np.float32), oiio.FLOAT)
        lut, exr = write_spi1d(tmp_path / "b.spi1d"), tmp_path / "b.exr"
        ended = facecrf("apply", photo, "--lut", lut, "--direction", way, "-o", exr)
        assert ended.code == DONE
        assert ("it is linear light already" in ended.out) == told

    @pytest.mark.parametrize("name", ["missing.cube", "a.png", "."])
    def test_bad_lut(self, facecrf: CommandLine, photo: Path, tmp_path: Path, name: str) -> None:
        ended = facecrf("apply", photo, "--lut", tmp_path / name, "-o", tmp_path / "a.exr")
        assert (ended.code, ended.out) == (UNREADABLE, "")
        assert ended.err.startswith(f"facecrf: {tmp_path / name}: ")
        assert ended.err.count("\n") == 1
        assert names_in(tmp_path) == {photo.name}


class TestNames:
    @pytest.mark.parametrize(
        "stem",
        [
            "two words",
            'quote\'s "and" so',
            "$HOME ${PWD}",
            "Zoë 写真",
            "-dash",
            "--json",
            "[bold]x",
            "50%d #### *?",
            "line\nbreak",
            ".hidden",
            "a.b.c",
        ],
    )
    def test_any_name_goes_through_all_commands(
        self, facecrf: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stem: str
    ) -> None:
        monkeypatch.chdir(tmp_path)
        name = f"{stem}.png"
        write_noise(tmp_path / name)
        ended = facecrf("calibrate", "-o", "out", "--plot", *BLIND, "--", name)
        assert (ended.code, ended.err) == (DONE, "")
        suffixes = ("spi1d", "cube", "clf", "crf.json", "crf.png")
        assert names_in(tmp_path / "out") == {f"{name}.{suffix}" for suffix in suffixes}
        assert len(ended.out.splitlines()) == 6
        ended = facecrf("apply", "--lut", f"out/{name}.clf", f"--output=out/{stem}.exr", "--", name)
        assert (ended.code, ended.err) == (DONE, "")
        assert (tmp_path / "out" / f"{stem}.exr").exists()

    def test_a_stdout_that_cannot_hold_them(self, tmp_path: Path) -> None:
        write_noise(tmp_path / "写.png")
        command = [sys.executable, "-c", CODE, "calibrate", "写.png", "-o", "out", *BLIND]
        ended = subprocess.run(
            command,
            cwd=tmp_path,
            env={**os.environ, "PYTHONIOENCODING": "latin-1"},
            capture_output=True,
            check=False,
        )
        assert (ended.returncode, ended.stderr) == (DONE, b"")
        assert ended.stdout.startswith(rb"\u5199.png: ")


class TestProgress:
    """A spinner on a terminal's stderr, and never a byte of it on stdout."""

    def run(self, folder: Path, *arguments: str, columns: int = 80) -> tuple[bytes, bytes]:
        pty = pytest.importorskip("pty")
        ours, theirs = pty.openpty()
        command = [sys.executable, "-c", CODE, *arguments]
        environment = {**os.environ, "TERM": "xterm", "COLUMNS": str(columns)}
        with subprocess.Popen(
            command, cwd=folder, stdout=subprocess.PIPE, stderr=theirs, env=environment
        ) as process:
            os.close(theirs)
            shown = b""
            try:
                while block := os.read(ours, 4096):
                    shown += block
            except OSError:  # how Linux says that the other end is closed
                pass
            assert process.stdout is not None
            printed = process.stdout.read()
        os.close(ours)
        return printed, shown

    def test_of_several_photos(self, tmp_path: Path) -> None:
        (tmp_path / "[a][").mkdir()  # [/b] would end a markup of rich that was never begun
        write_noise(tmp_path / "[a][/b].png")
        (tmp_path / "b.png").touch()
        command = ("calibrate", "[a][/b].png", "b.png", "-o", "out", "--json", *BLIND)
        printed, shown = self.run(tmp_path, *command)
        assert [json.loads(line)["exit_code"] for line in printed.splitlines()] == [0, 3]
        assert b"calibrating [a][/b].png (1 of 2)" in shown
        assert b"calibrating b.png (2 of 2)" in shown
        assert b"facecrf: b.png: is empty" in shown

    def test_of_one_photo(self, tmp_path: Path) -> None:
        write_noise(tmp_path / "a.png")
        printed, shown = self.run(tmp_path, "linearize", "a.png", "-o", "a.exr", *BLIND)
        assert b"linearizing a.png" in shown
        assert printed.decode().splitlines()[-1] == "  a.exr"

    @pytest.mark.parametrize("columns", [40, 70])
    def test_a_line_breaks_between_words(self, tmp_path: Path, columns: int) -> None:
        write_noise(tmp_path / "a.png")
        _, shown = self.run(tmp_path, "linearize", "a.png", "-o", "a.exr", columns=columns)
        told = shown.decode().replace("\r", "").partition("facecrf: ")[2]
        lines = ("facecrf: " + told).rstrip().split("\n")
        assert 2 <= len(lines) <= 8
        assert max(map(len, lines)) <= columns
        assert all(line.startswith("    ") for line in lines[1:])
        assert "not calibrated: no face found; " in " ".join(line.strip() for line in lines)

    @pytest.mark.parametrize("columns", [40, 120])
    def test_a_bar_of_an_archive_fits_the_terminal(self, tmp_path: Path, columns: int) -> None:
        (tmp_path / "in").mkdir()
        for name in "abc":
            write_noise(tmp_path / "in" / f"{name}.png")
        options = ("--estimator", "mean", "--jobs", "1", "--formats", "spi1d")
        command = ("batch", "in", "-o", "out", *options)
        _, shown = self.run(tmp_path, *command, columns=columns)
        assert "3 of 3 photos" in shown.decode()
        assert shown.decode().rstrip().endswith("to look at it: facecrf report out")
        assert 0 < self.widest_bar(shown) <= columns
        printed, shown = self.run(tmp_path, "report", "out", columns=columns)
        assert b"3 photos" in printed
        assert b"3 of 3 photos" in shown
        luts = sorted(str(path.relative_to(tmp_path)) for path in tmp_path.glob("out/*.spi1d"))
        (tmp_path / "no.cube").touch()
        printed, shown = self.run(tmp_path, "lint", *luts, "no.cube", columns=columns)
        assert b"2 of 4: out/c.png.spi1d" in shown
        assert b"no.cube: " in printed
        assert 0 < self.widest_bar(shown) <= columns

    def test_a_bar_of_a_pair_tells_its_steps(self, tmp_path: Path) -> None:
        for name in "ab":
            write_noise(tmp_path / f"{name}.png")
        _, shown = self.run(tmp_path, "pair", "a.png", "b.png", "-o", "out")
        for step in (b"reading b.png", b"reading a.png", b"fitting b.png to a.png"):
            assert step in shown

    @staticmethod
    def widest_bar(shown: bytes) -> int:
        """Letters of the widest line with a bar; 0 without any."""
        drawn = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown.decode())
        lines = re.split(r"[\r\n]+", drawn)
        return max((len(line) for line in lines if "\u2501" in line or "\u2578" in line), default=0)

    def test_what_is_said_above_a_bar_of_several_lines_stays(self, tmp_path: Path) -> None:
        (tmp_path / "in").mkdir()
        for name in "ab":
            write_noise(tmp_path / "in" / f"{name}.png")
        (tmp_path / "in" / "a.png").write_bytes(b"")
        options = ("--estimator", "mean", "--jobs", "1", "--formats", "spi1d")
        _, shown = self.run(tmp_path, "batch", "in", "-o", "out", *options, columns=50)
        lines = self.screen(shown)
        assert " ".join(line.strip() for line in lines[:3]).startswith(
            "facecrf: a.png: failed: is empty (zero bytes); copy it again from the camera or "
            "from a backup 2 of 2 photos"
        )
        assert lines[-1] == "  to look at it: facecrf report out"

    @staticmethod
    def screen(shown: bytes) -> list[str]:
        """What stays of what a terminal was sent: lines up, lines cleared, begun again."""
        lines, row, begun = [""], 0, True
        moves = re.compile(r"\x1b\[([0-9;?]*)([A-Za-z])|(\r)|(\n)|([^\x1b\r\n]+)")
        for number, what, to_start, down, text in moves.findall(shown.decode()):
            if what == "A":
                row = max(row - int(number or 1), 0)
            elif what == "K":
                lines[row] = ""
            elif to_start:
                begun = True
            elif down:
                row += 1
                lines += [""] * (row + 1 - len(lines))
                begun = True
            elif text:
                lines[row] = text if begun else lines[row] + text
                begun = False
        return [line.rstrip() for line in lines if line.strip()]


class TestInterrupted:
    """Ctrl-C is one line, a code of its own, and nothing half written."""

    @pytest.mark.parametrize("kind", ["at once", "while a library is loaded"])
    def test_is_told_in_one_line(
        self, facecrf: CommandLine, monkeypatch: pytest.MonkeyPatch, kind: str
    ) -> None:
        def stop() -> None:
            try:
                raise KeyboardInterrupt
            except KeyboardInterrupt as interrupt:
                if kind == "at once":
                    raise
                raise ImportError("initialization failed") from interrupt

        monkeypatch.setattr(versions, "versions", stop)
        ended = facecrf("doctor")
        assert (ended.code, ended.out) == (130, "")
        assert ended.err.startswith("facecrf: interrupted; ")
        assert ended.err.count("\n") == 1

    def test_what_was_done_is_whole_and_the_rest_is_not_there(
        self, facecrf: CommandLine, tmp_path: Path, out: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        photos = [write_noise(tmp_path / f"{name}.png") for name in "ab"]

        def stop(_: Path) -> None:
            if (out / "b.png.spi1d").exists():
                raise KeyboardInterrupt

        monkeypatch.setattr(atomic, "_sync_folder", stop)
        ended = facecrf("calibrate", *photos, "-o", out, *BLIND)
        assert (ended.code, ended.err.count("\n")) == (130, 1)
        assert names_in(out) == ALL


class TestManyPhotos:
    def test_each_gets_an_exr_in_the_folder(
        self, facecrf: CommandLine, tmp_path: Path, out: Path
    ) -> None:
        photos = [write_noise(tmp_path / f"{name}.png") for name in "ab"]
        broken = tmp_path / "c.png"
        broken.write_bytes(photos[0].read_bytes()[:-20])
        ended = facecrf("linearize", *photos, broken, "-o", out, *BLIND)
        assert ended.code == UNREADABLE
        assert names_in(out) == {"a.png.exr", "b.png.exr"}
        again = facecrf("linearize", *photos, "-o", out, *BLIND)
        assert again.code == FAILED
        assert len(again.err.splitlines()) == 2
        assert facecrf("linearize", *photos, "-o", out, "--overwrite", *BLIND).code == DONE

    def test_one_photo_goes_to_a_folder_as_several_do(
        self, facecrf: CommandLine, photo: Path, out: Path
    ) -> None:
        assert facecrf("linearize", photo, "-o", out, *BLIND).code == DONE
        assert names_in(out) == {"a.png.exr"}

    def test_one_file_or_one_name_for_two_photos(
        self, facecrf: CommandLine, tmp_path: Path, out: Path
    ) -> None:
        (tmp_path / "b").mkdir()
        photos = [write_noise(tmp_path / "a.png"), write_noise(tmp_path / "b" / "a.png")]
        ended = facecrf("linearize", *photos, "-o", tmp_path / "a.exr", *BLIND)
        assert (ended.code, "name a folder" in ended.err) == (USAGE, True)
        ended = facecrf("linearize", *photos, "-o", out, *BLIND)
        assert ended.code == FAILED
        assert "would write the same files" in ended.err
        assert names_in(out) == set()


class TestCompletion:
    @pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
    def test_a_script_for_each_shell(self, facecrf: CommandLine, shell: str) -> None:
        ended = facecrf("completion", shell)
        assert ended.code == DONE
        assert f"_FACECRF_COMPLETE={shell}_complete" in ended.out

    def test_bash_completes_options(self, facecrf: CommandLine, tmp_path: Path) -> None:
        bash = shutil.which("bash")
        if bash is None:
            pytest.skip("bash is not here")
        command = tmp_path / "facecrf"
        code = "from facecrf_ocio.cli.facecrf import main; main(prog_name='facecrf')"
        command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -c "{code}"\n', encoding="utf-8")
        command.chmod(0o755)
        asked = "COMP_WORDS=(facecrf calibrate --to); COMP_CWORD=2; "
        ask = f'{facecrf("completion", "bash").out}\n{asked}_facecrf_completion "{command}"; '
        ended = subprocess.run(
            [bash, "-c", ask + 'echo "${COMPREPLY[@]}"'], capture_output=True, check=True, text=True
        )
        assert {"--to", "--together"} <= set(ended.stdout.split())
