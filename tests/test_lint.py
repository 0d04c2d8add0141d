"""A linter finds what is broken, and nothing in what is whole."""

from __future__ import annotations

import json
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt
import PyOpenColorIO as ocio  # noqa: N813
import pytest
from command_line import CommandLine
from hypothesis import given, settings
from hypothesis import strategies as st
from lut_files import (
    LOG_TO_INFINITY,
    MIXES,
    half_floats,
    matrix,
    through_ocio,
    write_clf,
    write_half_domain,
)
from PIL import ImageCms

from facecrf_ocio.color.working_space import WORKING_SPACES
from facecrf_ocio.errors import LutError
from facecrf_ocio.lut.format_table import FORMATS
from facecrf_ocio.lut.lint import lint
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.response.model import dorf_model, strictly_increasing
from facecrf_ocio.values import InverseCRF

WORDS = st.sampled_from(
    [w.encode() for w in ("²", "1e999", "-1", "nan ", "\n", "3D", "rawHalfs='true' ", "UTF-7")]
)
Values = npt.NDArray[np.float64]
NODES = np.linspace(0.0, 1.0, 4096)
CURVE = InverseCRF(NODES, np.stack([NODES**2.4, NODES**2.2, NODES**1.8]))
RAMP = "".join(f"{v:.6g} {v:.6g} {v:.6g}\n" for v in np.linspace(0, 1, 32))
SPI1D = f"Version 1\nFrom 0 1\nLength 32\nComponents 3\n{{\n{RAMP}}}\n"
CUBE = f"LUT_1D_SIZE 32\nLUT_1D_INPUT_RANGE 0 1\n{RAMP}"
IRIDAS = f'TITLE "1,5 and 2,2"\nDOMAIN_MIN 0 0 0\nDOMAIN_MAX 1 1 1\nLUT_1D_SIZE 32\n{RAMP}'
SHAPER = "2\n0 1\n0 1\n" * 3
CSP = f"CSPLUTV100\n1D\n\nBEGIN METADATA\n1,2 3D\nEND METADATA\n\n{SHAPER}\n32\n{RAMP}"
CLF = (
    '<?xml version="1.0" encoding="UTF-8"?>\n<ProcessList compCLFversion="3" id="a">\n'
    '<LUT1D inBitDepth="32f" outBitDepth="32f">\n<Array dim="32 3">\n'
    f"{RAMP}</Array>\n</LUT1D>\n</ProcessList>\n"
)
MATRIX = '<Matrix inBitDepth="32f" outBitDepth="32f"><Array dim="3 3">1 0 0\n0 nan 0\n0 0 1'

BROKEN = {
    "NaN": ("a.spi1d", SPI1D.replace("0.0322581 ", "nan ", 1), 7, "error", "NaN"),
    "reversed": ("a.spi1d", SPI1D.replace("From 0 1", "From 1 0"), 2, "error", "reversed"),
    "commas": ("a.cube", CUBE.replace("0.", "0,"), 4, "error", "decimal comma"),
    "decreasing": ("a.cube", CUBE.replace("0.0645161 ", "0.01 ", 1), 5, "error", "decreases"),
    "length": ("a.cube", CUBE.replace("SIZE 32", "SIZE 33"), None, "error", "33 are promised"),
    "3-D": ("a.cube", CUBE.replace("1D_SIZE", "3D_SIZE"), 1, "error", "3-D LUT"),
    "jump": ("a.cube", CUBE.replace("\n0.", "\n0.0"), None, "warning", "jumps"),
    "reversed blue of Iridas": (
        *("a.cube", IRIDAS.replace("MAX 1 1 1", "MAX 1 1 -1"), 2, "error"),
        "the domain of B is reversed",
    ),
    "empty green of Iridas": (
        *("a.cube", IRIDAS.replace("MIN 0 0 0", "MIN 0 1 0"), 2, "error"),
        "the domain of G is empty",
    ),
    "only a reversed end of Iridas": (
        *("a.cube", IRIDAS.replace("DOMAIN_MAX 1 1 1\n", "").replace("MIN 0", "MIN 2"), 2),
        *("error", "the domain of R is reversed"),
    ),
    "reversed domain of Resolve": (
        *("a.cube", CUBE.replace("RANGE 0 1", "RANGE 1 0"), 2, "error", "reversed"),
    ),
    "codes as domain": (
        *("a.cube", CUBE.replace("RANGE 0 1", "RANGE 0 1023"), 2, "warning", "goes up to 1023"),
    ),
    "domain of words": ("a.spi1d", SPI1D.replace("From 0 1", "From 0 x"), 2, "error", "numbers"),
    "reversed green of cineSpace": (
        *("a.csp", CSP.replace("0 1\n2\n0 1\n", "0 1\n2\n1 0\n", 1), 12, "error"),
        "the domain of G is reversed",
    ),
    "reversed shaper of cineSpace": (
        *("a.csp", CSP.replace("2\n0 1\n0 1\n\n32", "2\n0 1\n1 0\n\n32"), 16, "error"),
        "the shaper of B is reversed",
    ),
    "no size, .cube": ("a.cube", CUBE.replace("LUT_1D_SIZE 32\n", ""), None, "error", "no size"),
    "no size, .spi1d": ("a.spi1d", SPI1D.replace("Length 32\n", ""), None, "error", "no size"),
    "no size, .csp": ("a.csp", CSP.replace("\n32\n", "\n"), None, "error", "no size"),
    "size of words": ("a.cube", CUBE.replace("SIZE 32", "SIZE many"), 1, "error", "size is 'many'"),
    "a word in a row": ("a.cube", CUBE.replace("0.0322581 ", "zero ", 1), None, "error", "entries"),
    "a word behind a row": ("a.cube", CUBE.replace("\n1 1 1", "\n1 1 x"), 34, "error", "numbers"),
    "NaN, .clf": ("a.clf", CLF.replace("0.0322581 ", "nan ", 1), 6, "error", "NaN"),
    "commas, .clf": ("a.clf", CLF.replace("0.0645161 ", "0,06 ", 1), 7, "error", "decimal comma"),
    "words, .clf": ("a.clf", CLF.replace("0.0645161 ", "x ", 1), 7, "error", "not numbers"),
    "decreasing, .clf": ("a.clf", CLF.replace("0.0645161 ", "0.01 ", 1), 7, "error", "R decreases"),
    "length, .clf": ("a.clf", CLF.replace("32 3", "33 3"), 4, "error", "33 are promised"),
    "3-D, .clf": ("a.clf", CLF.replace("LUT1D", "LUT3D"), 3, "error", "3-D LUT"),
    "NaN in a matrix": (
        *("a.clf", CLF.replace("</LUT1D>", f"</LUT1D>\n{MATRIX}</Array></Matrix>"), 40, "error"),
        "a matrix holds NaN",
    ),
    "no LUT, .clf": ("a.clf", "<ProcessList/>", None, "error", "no 1-D LUT"),
    "not XML": ("a.clf", "<ProcessList", 1, "error", "no XML"),
    "not ICC": ("a.icc", "x", None, "error", "no ICC profile"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_each_fault_is_found(name: str, tmp_path: Path) -> None:
    file, text, line, severity, problem = BROKEN[name]
    (tmp_path / file).write_text(text)
    found = [f for f in lint(tmp_path / file) if problem in f.problem]
    assert found
    assert found[0].severity == severity
    assert line is None or found[0].line == line
    assert file in str(found[0])


@pytest.mark.parametrize(
    ("values", "end", "line"),
    [
        (np.minimum(1.0, np.linspace(0, 1.5, 32)), "the top 11 entries of R are clipped", 23),
        (np.maximum(0.0, np.linspace(-0.5, 1, 32)), "the bottom 11 entries of R are clipped", 13),
        (np.full(32, 0.5), "R is constant", 2),
    ],
)
def test_clipped_ends_are_found(values: Values, end: str, line: int, tmp_path: Path) -> None:
    rows = "".join(f"{v:.6g} {v:.6g} {v:.6g}\n" for v in values)
    (tmp_path / "a.cube").write_text(f"LUT_1D_SIZE 32\n{rows}")
    found = lint(tmp_path / "a.cube")
    assert [f.severity for f in found] == ["warning"] * 3
    assert (found[0].problem, found[0].line) == (end, line)


def test_steps_steeper_than_any_camera_are_found_in_long_tables(tmp_path: Path) -> None:
    values = np.where(NODES < 0.5, 0.8 * NODES, 0.8 * NODES + 0.2)
    (tmp_path / "a.spi1d").write_text(
        "Version 1\nFrom 0 1\nLength 4096\nComponents 1\n{\n"
        + "".join(f"{value:.9g}\n" for value in values)
        + "}\n"
    )
    (found,) = lint(tmp_path / "a.spi1d")
    assert (found.severity, found.line) == ("warning", 6 + 2048)
    assert found.problem == "the curve jumps by 0.2"


def test_integers_and_raw_half_floats_of_a_process_list_are_understood(tmp_path: Path) -> None:
    codes = np.linspace(0, 1023, 32).round()
    halfs = np.linspace(0, 1, 32).astype(np.float16).view(np.uint16)
    for name, values, old, new in (
        ("integers", codes, 'outBitDepth="32f"', 'outBitDepth="10i"'),
        ("halfs", halfs, 'outBitDepth="32f"', 'outBitDepth="16f" rawHalfs="true"'),
    ):
        rows = "".join(f"{value:g} {value:g} {value:g}\n" for value in values)
        (tmp_path / f"{name}.clf").write_text(CLF.replace(RAMP, rows).replace(old, new))
        assert lint(tmp_path / f"{name}.clf") == ()


def test_curves_of_icc_profiles_are_looked_into(tmp_path: Path) -> None:
    whole = write_lut(CURVE, tmp_path / "a.v4.icc").read_bytes()
    broken = {
        "the curve rTRC decreases": (b"curv", 12 + 200, b"\xff\xff"),
        "an entry is NaN or infinite": (b"samf", 12 + 400, b"\x7f\xc0\0\0"),
        "the curve decreases": (b"samf", 12 + 400, b"\x40\0\0\0"),
    }
    for problem, (kind, offset, damage) in broken.items():
        place = whole.index(kind) + offset
        content = whole[:place] + damage + whole[place + len(damage) :]
        (tmp_path / "b.icc").write_bytes(content)
        assert problem in [finding.problem for finding in lint(tmp_path / "b.icc")]
    (tmp_path / "b.icc").write_bytes(whole[: len(whole) // 2])
    assert lint(tmp_path / "b.icc")


def test_profiles_of_formulas_are_clean(tmp_path: Path) -> None:
    (tmp_path / "a.icc").write_bytes(
        ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    )
    assert lint(tmp_path / "a.icc") == ()


@st.composite
def responses(draw: st.DrawFn) -> InverseCRF:
    """Responses drawn from the model, kept from being flat by a little of a power function."""
    model = dorf_model()
    numbers = st.floats(-2.0, 2.0)
    spread = np.sqrt(np.diag(model.mixture.covariances.mean(axis=0)))
    power = model.grid ** draw(st.floats(0.5, 4.0))
    channels = []
    for _ in range(3):
        deviations = np.array([draw(numbers) for _ in spread]) * spread
        sample = model.samples(deviations)
        channels.append(0.95 * strictly_increasing(sample[None])[0] + 0.05 * power)
    return model.inverse_crf(np.stack(channels))


@pytest.mark.slow
@pytest.mark.parametrize("direction", ["linearize", "encode"])
@pytest.mark.parametrize("ending", FORMATS)
@settings(max_examples=8, deadline=None)
@given(curve=responses(), space=st.sampled_from(["", *WORKING_SPACES]))
def test_whatever_we_write_is_clean(
    ending: str,
    direction: str,
    curve: InverseCRF,
    space: str,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    if ending.endswith("icc") and direction == "encode":
        pytest.skip("an ICC input profile has one direction")
    path = tmp_path_factory.mktemp("lut") / f"a.{ending}"
    write_lut(curve, path, direction=direction, space=space if ending in ("clf", "ctf") else "")
    assert lint(path) == ()


@pytest.mark.parametrize("direction", ["linearize", "encode"])
@pytest.mark.parametrize("suffix", FORMATS)
def test_what_we_write_is_clean(suffix: str, direction: str, tmp_path: Path) -> None:
    if suffix.endswith("icc") and direction == "encode":
        pytest.skip("an ICC input profile has one direction")
    path = write_lut(CURVE, tmp_path / f"a.{suffix}", direction=direction)
    assert lint(path) == ()


@pytest.mark.parametrize(
    ("name", "text"),
    [("a.spi1d", SPI1D), ("a.cube", CUBE), ("a.cube", IRIDAS), ("a.csp", CSP), ("a.clf", CLF)],
)
def test_a_ramp_is_clean(name: str, text: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_text(text)
    assert lint(path) == ()


@pytest.fixture(scope="module")
def whole_files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    short = InverseCRF(np.array([0.0, 1.0]), np.array([[0.0, 1.0]] * 3))
    folder = tmp_path_factory.mktemp("whole")
    profile = write_lut(short, folder / "a.v4.icc").read_bytes()
    texts = {"a.spi1d": SPI1D, "a.cube": IRIDAS, "a.csp": CSP, "a.clf": CLF}
    formula = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    files = {name: text.encode() for name, text in texts.items()}
    return {**files, "a.icc": profile, "formula.icc": formula}


@pytest.mark.slow  # what hangs OpenColorIO costs half a second each
@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_no_damage_ends_in_anything_but_findings(
    data: st.DataObject, whole_files: dict[str, bytes], tmp_path_factory: pytest.TempPathFactory
) -> None:
    name = data.draw(st.sampled_from(sorted(whole_files)))
    content = bytearray(whole_files[name])
    for _ in range(data.draw(st.integers(1, 4))):
        # Heads are where most of the meaning is.
        last = data.draw(st.sampled_from([200, 800, len(content)]))
        start = data.draw(st.integers(0, min(last, len(content))))
        end = start + data.draw(st.integers(0, 8))
        content[start:end] = data.draw(st.one_of(st.binary(max_size=8), WORDS))
    path = tmp_path_factory.getbasetemp() / name
    path.write_bytes(content)
    assert all(finding.severity in ("error", "warning") for finding in lint(path))


UNUSABLE = {
    "Components": ("a.spi1d", SPI1D.replace("Components 3\n", "")),
    "'DOMAIN_MAX 2 2 2'. Malformed color": ("a.cube", f"{CUBE}DOMAIN_MAX 2 2 2\n"),
    "At line 3: inBitDepth is missing": ("a.clf", CLF.replace('inBitDepth="32f" ', "")),
    "65536 required for halfDomain": ("a.clf", CLF.replace("<LUT1D", '<LUT1D halfDomain="true"')),
    "Prelut does not specify": ("a.csp", CSP.replace("2\n0 1", "two\n0 1", 1)),
}


@pytest.mark.parametrize("reason", UNUSABLE)
def test_what_opencolorio_refuses_is_an_error_with_its_reason_in_full(
    reason: str, tmp_path: Path
) -> None:
    file, text = UNUSABLE[reason]
    (tmp_path / file).write_text(text)
    found = lint(tmp_path / file)
    assert [finding.unusable for finding in found][-1]
    assert found[-1].severity == "error"
    with pytest.raises(ocio.Exception) as refused:
        ocio.Config.CreateRaw().getProcessor(ocio.FileTransform(str(tmp_path / file)))
    whole = " ".join(str(refused.value).replace(str(tmp_path / file), file).split())
    assert reason in whole
    whole = whole.replace(" (Enable debug log for errors from all formats.)", "")
    assert whole in found[-1].problem


def integers_of_fractions(text: str) -> str:
    return text.replace('outBitDepth="32f"', 'outBitDepth="16i"')


RANGES = {
    "255": ("a.cube", "LUT_1D_SIZE 4\n0 0 0\n26 26 26\n102 102 102\n255 255 255\n"),
    "1.5e-05": ("a.clf", integers_of_fractions(CLF)),
}


@pytest.mark.parametrize("white", RANGES)
def test_white_elsewhere_than_at_1_is_found(white: str, tmp_path: Path) -> None:
    file, text = RANGES[white]
    (tmp_path / file).write_text(text)
    (found, *_) = lint(tmp_path / file)
    assert (found.severity, f"goes up to {white}" in found.problem) == ("error", True)


def test_ends_of_lines_marks_and_unknown_words_are_found(tmp_path: Path) -> None:
    for content, problem in (
        (CUBE.replace("\n", "\r").encode(), "its lines end in CR alone"),
        (b"\xef\xbb\xbf" + CUBE.encode(), "byte-order mark"),
        (CUBE.encode("utf-16"), "two bytes a letter"),
        (CUBE.replace("\n", "\nLUT_IN_VIDEO_RANGE\n", 1).encode(), "'LUT_IN_VIDEO_RANGE'"),
    ):
        (tmp_path / "a.cube").write_bytes(content)
        assert problem in lint(tmp_path / "a.cube")[0].problem
    (tmp_path / "a.cube").write_bytes(CUBE.replace("\n", "\r\n").encode())
    assert lint(tmp_path / "a.cube") == ()


class TestHalfDomains:
    """All finite half floats are looked at, in the order of their values."""

    @pytest.mark.parametrize("at", [0.5, 2.0, -3.0])
    def test_nan_anywhere_is_found(self, at: float, tmp_path: Path) -> None:
        values = half_floats()
        values[values == at] = np.nan
        (found,) = lint(write_half_domain(tmp_path / "a.clf", values))
        assert found.problem == "an entry is NaN or infinite"

    def test_falls_above_1_are_found(self, tmp_path: Path) -> None:
        values = np.where(half_floats() > 4.0, 3.0, half_floats())
        (found,) = lint(write_half_domain(tmp_path / "a.clf", values))
        assert found.problem == "the curve decreases"

    def test_what_is_infinite_of_the_infinite_is_clean(self, tmp_path: Path) -> None:
        assert lint(write_half_domain(tmp_path / "a.clf", half_floats())) == ()


def pq(light: Values) -> Values:
    """SMPTE ST 2084: code values of light, of which 1 is 10,000 cd/m2."""
    power = light**0.1593017578125
    return np.asarray(((0.8359375 + 18.8515625 * power) / (1 + 18.6875 * power)) ** 78.84375)


def log_c3(codes: Values) -> Values:
    """ARRI LogC3, EI 800: linear light of code values."""
    curved = (10 ** ((codes - 0.385537) / 0.247190) - 0.052272) / 5.555556
    return np.where(codes > 0.1496582, curved, (codes - 0.092809) / 5.367655)


@pytest.mark.parametrize("size", [256, 1024, 4096])
def test_what_others_publish_is_clean(size: int, tmp_path: Path) -> None:
    codes = np.linspace(0, 1, size)
    curves = {
        "LogC3": log_c3(codes),
        "LogC3 back": np.interp(codes, log_c3(NODES) / log_c3(np.ones(1)), NODES),
        "PQ": pq(codes),
        "PQ back": np.interp(codes, pq(NODES**4), NODES**4) * 100.0,
        "logarithm of base 2": np.log2(1 + 1000 * codes) / np.log2(1001),
        "Canon Log 2 like": np.sign(codes - 0.09) * (10 ** (np.abs(codes - 0.09) / 0.24) - 1) / 87,
    }
    for name, values in curves.items():
        rows = "".join(f"{value:.9g}\n" for value in values)
        path = tmp_path / "a.spi1d"
        path.write_text(f"Version 1\nFrom 0 1\nLength {size}\nComponents 1\n{{\n{rows}}}\n")
        assert lint(path) == (), name


def test_scene_linear_domains_and_missing_shapers_are_clean(tmp_path: Path) -> None:
    clean = {
        "a.cube": CUBE.replace("RANGE 0 1", "RANGE 0 16.293"),
        "a.spi1d": SPI1D.replace("From 0 1", "From -0.125 65504"),
        "a.csp": CSP.replace(SHAPER, "3\n0 1 55\n0 0.5 1\n" * 3),
        "b.csp": CSP.replace(SHAPER, "0\n0\n0\n"),
    }
    for name, text in clean.items():
        (tmp_path / name).write_text(text)
        assert lint(tmp_path / name) == (), name


def test_formulas_matrices_and_solids_are_sampled(tmp_path: Path) -> None:
    assert lint(write_clf(tmp_path / "a.clf", LOG_TO_INFINITY, matrix(MIXES))) == ()
    (tmp_path / "a.cube").write_text("LUT_3D_SIZE 2\n" + "0 0 0\n0.5 1 1\n" * 4)
    assert lint(tmp_path / "a.cube") == ()
    (tmp_path / "a.cube").write_text("LUT_3D_SIZE 2\n" + "0 0 0\nnan 1 1\n" * 4)
    assert "NaN" in lint(tmp_path / "a.cube")[0].problem
    (tmp_path / "a.3dl").write_text("0 1023\n" + "0 0 0\n" * 3)
    assert lint(tmp_path / "a.3dl")[-1].unusable


def test_steps_for_false_color_are_no_curve(tmp_path: Path) -> None:
    values = np.take([0.0, 0.5, 0.2, 1.0], np.arange(1024) // 256)
    rows = "".join(f"{value:g}\n" for value in values)
    (tmp_path / "a.spi1d").write_text(
        f"Version 1\nFrom 0 1\nLength 1024\nComponents 1\n{{\n{rows}}}\n"
    )
    assert lint(tmp_path / "a.spi1d") == ()


def test_what_opencolorio_warns_of_is_found(tmp_path: Path) -> None:
    path = tmp_path / "a.clf"
    path.write_text(CLF.replace("<LUT1D", "<Comment>x</Comment>\n<LUT1D"))
    (found,) = lint(path)
    assert (found.severity, found.line) == ("warning", 3)
    assert "Unrecognized element 'Comment'" in found.problem


def test_a_profile_under_its_other_suffix(tmp_path: Path) -> None:
    path = write_lut(CURVE, tmp_path / "a.icc").rename(tmp_path / "a.icm")
    assert lint(path) == ()


def tag_bomb() -> bytes:
    """Thousands of tags that share one curve of 8,000 entries."""
    curve = b"curv" + bytes(4) + struct.pack(">I", 8000) + bytes(16000)
    count = 1500
    tags = b"".join(
        b"rTRC" + struct.pack(">II", 132 + 12 * count, len(curve)) for _ in range(count)
    )
    return b"\0" * 36 + b"acsp" + b"\0" * 88 + struct.pack(">I", count) + tags + curve


def endless_description() -> bytes:
    """A profile that says of its description that it has a thousand million letters."""
    codes = np.linspace(0.0, 1.0, 32)
    with tempfile.TemporaryDirectory() as folder:
        written = write_lut(InverseCRF(codes, np.stack([codes**2.2] * 3)), Path(folder, "a.icc"))
        content = bytearray(written.read_bytes())
    at = content.index(b"desc", content.index(b"desc", 132) + 4)
    content[at + 4 : at + 12] = bytes(4) + struct.pack(">I", 0x3F521003)
    return bytes(content)


HOSTILE = {
    "digits.spi1d": f"Version 1\nFrom 0 1\nLength 1\nComponents 1\n{{\n{'1' * 200000}x\n}}\n",
    "size.cube": f"LUT_1D_SIZE {'9' * 5000}\n0 0 0\n",
    "dim.clf": CLF.replace("32 3", f"{'9' * 5000} 3"),
    "spaces.cube": "LUT_1D_SIZE 2\n" + " " * 300000 + "x\n",
    "commas.cube": "LUT_1D_SIZE 2\n" + "1" * 200000 + "\n",
    "endless.csp": "CSPLUTV100\n1D\n\nBEGIN METADATA\n# c\nEND ",
    "tags.icc": tag_bomb(),
    "text.icc": endless_description(),
    "rows.cube": "LUT_1D_SIZE 2\n" + "0 0 0\n" * 400000,
}


def test_blackmagics_own_keyword_is_known(tmp_path: Path) -> None:
    colors = "".join(f"{r} {g} {b}\n" for b in (0, 1) for g in (0, 1) for r in (0, 1))
    for name in ("BMD", "MY"):
        text = f'{name}_TITLE "Film to Video"\n\nLUT_3D_SIZE 2\n{colors}'
        (tmp_path / f"{name}.cube").write_text(text, encoding="utf-8")
    assert not lint(tmp_path / "BMD.cube")
    assert "no keyword 'MY_TITLE' is known" in lint(tmp_path / "MY.cube")[0].problem


# What a file costs: processor time here, and in the process that asks OpenColorIO beyond its start,
# which a sound file tells; memory here, and there beyond that of the sound file.
COST = """
import sys, time
from pathlib import Path
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage
from facecrf_ocio.lut import usable
from facecrf_ocio.lut.lint import lint

def asked():
    usable._child.stop()
    spent = getrusage(RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime

lint(Path(sys.argv[1]))
start = asked()
small = getrusage(RUSAGE_CHILDREN).ru_maxrss
before, begin = getrusage(RUSAGE_SELF).ru_maxrss, time.process_time()
found = lint(Path(sys.argv[2]))
own = time.process_time() - begin
peak = getrusage(RUSAGE_SELF).ru_maxrss
other = asked() - 2 * start
large = getrusage(RUSAGE_CHILDREN).ru_maxrss
print(len(found) > 0, own, other, (peak - before) / 1024, (large - small) / 1024)
"""


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_files_end_soon_and_small(name: str, tmp_path: Path) -> None:
    content = HOSTILE[name]
    (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    (tmp_path / "sound.cube").write_text("LUT_1D_SIZE 2\n0 0 0\n1 1 1\n", encoding="utf-8")
    pytest.importorskip("resource")
    arguments = [sys.executable, "-c", COST, tmp_path / "sound.cube", tmp_path / name]
    ended = subprocess.run(arguments, capture_output=True, text=True, check=True, timeout=120)
    wrong, own, asked, megabytes, asked_megabytes = ended.stdout.split()
    assert wrong == "True"
    assert float(own) < 2.0
    assert float(asked) < 2.0
    assert float(megabytes) < 100.0
    if sys.platform.startswith("linux"):  # others limit no addresses
        assert float(asked_megabytes) < 100.0


def test_what_cannot_be_read_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(LutError, match="cannot be read: no such file"):
        lint(tmp_path / "a.cube")
    with pytest.raises(LutError, match="lint knows"):
        lint(tmp_path / "a.exr")


def test_a_run_tells_how_many_files_it_looked_at(facecrf: CommandLine, tmp_path: Path) -> None:
    (tmp_path / "below").mkdir()
    (tmp_path / "a.cube").write_text(CUBE)
    (tmp_path / "below" / "b.cube").write_text(CUBE)
    (tmp_path / "below" / "notes.txt").write_text("no LUT")
    ended = facecrf("lint", tmp_path)
    assert (ended.code, ended.out) == (0, "2 LUTs looked at: nothing is wrong\n")
    file, text, *_ = BROKEN["decreasing"]
    (tmp_path / file).write_text(text)
    ended = facecrf("lint", tmp_path / "below" / "b.cube", tmp_path / file)
    assert ended.code == 6
    told = "2 LUTs looked at: 1 clean, 1 with what is told above"
    assert ended.out.splitlines()[-1] == told
    assert facecrf("lint", "--json", tmp_path / "below").out == ""


def test_a_folder_without_a_lut_is_told(facecrf: CommandLine, tmp_path: Path) -> None:
    ended = facecrf("lint", tmp_path)
    assert (ended.code, ended.out) == (3, "")
    assert ended.err == f"facecrf: {tmp_path}: holds no LUT; name another folder, or a file\n"


ENDS = {"clean": 0, "jump": 5, "codes as domain": 5, "decreasing": 6, "length": 7, "words, .clf": 7}


@pytest.mark.parametrize("name", ENDS)
def test_the_command_tells_and_ends_by_severity(name: str, tmp_path: Path) -> None:
    file, text, *_ = BROKEN.get(name, ("a.cube", CUBE))
    (tmp_path / file).write_text(text)
    run = "from facecrf_ocio.cli.lint_command import lint; lint()"
    arguments = [sys.executable, "-c", run, "--json", str(tmp_path / file)]
    ended = subprocess.run(arguments, capture_output=True, text=True, check=False)
    assert ended.returncode == ENDS[name]
    told = [json.loads(line) for line in ended.stdout.splitlines()]
    assert {finding["path"] for finding in told} <= {str(tmp_path / file)}
    assert any(finding["unusable"] for finding in told) == (ENDS[name] == 7)


def test_what_becomes_nan_in_opencolorio_is_found(tmp_path: Path) -> None:
    shaper = "3\n0 0.5 0.5\n0 0.5 1\n"  # an input twice
    rows = "\n".join(f"{x / 15:.4f} {x / 15:.4f} {x / 15:.4f}" for x in range(16))
    text = f"CSPLUTV100\n1D\n\nBEGIN METADATA\nEND METADATA\n\n{shaper * 3}\n16\n{rows}\n"
    (tmp_path / "a.csp").write_text(text)
    (finding,) = lint(tmp_path / "a.csp")
    assert finding.severity == "error"
    assert "NaN or infinity as OpenColorIO reads it" in finding.problem


def test_a_short_table_that_is_constant_is_found(tmp_path: Path) -> None:
    (tmp_path / "a.cube").write_text("LUT_1D_SIZE 4\n" + "0.5 0.5 0.5\n" * 4)
    assert [one.problem for one in lint(tmp_path / "a.cube")] == [f"{c} is constant" for c in "RGB"]


@pytest.mark.parametrize("bits", [10, 12, 16])
@pytest.mark.parametrize("white", [1.0, 0.6, 0.4, 0.2])
def test_a_3dl_whose_bits_opencolorio_guesses_wrong_is_found(
    bits: int, white: float, tmp_path: Path
) -> None:
    code = round(white * (2**bits - 1))
    grid = [code * step // 4 for step in range(5)]
    rows = (f"{r} {g} {b}" for r in grid for g in grid for b in grid)
    path = tmp_path / "a.3dl"
    path.write_text(
        f"3DMESH\nMesh 2 {bits}\n0 256 512 767 1023\n" + "\n".join(rows) + "\nLUT8\ngamma 1.0\n"
    )
    is_right = np.allclose(through_ocio(path, np.ones((1, 3))), white, atol=2e-3)
    told = [str(finding) for finding in lint(path)]
    assert (told == []) == is_right
    assert is_right or f"and they are {bits}; export it as .cube" in told[0]


@pytest.mark.parametrize("solid", [False, True])
def test_a_title_beside_an_input_range_is_told_with_what_helps(solid: bool, tmp_path: Path) -> None:
    kind, rows = ("3", "0 0 0\n1 1 1\n" * 4) if solid else ("1", RAMP)
    size = 2 if solid else 32
    text = f"LUT_{kind}D_SIZE {size}\nLUT_{kind}D_INPUT_RANGE 0.0 1.0\n{rows}"
    path = tmp_path / "a.cube"
    path.write_text(text)
    assert not any(finding.unusable for finding in lint(path))
    path.write_text(f'TITLE "as Resolve writes it"\n{text}')
    title, refused = lint(path)
    assert (title.line, refused.unusable) == (1, True)
    assert title.remedy == "take the line with TITLE out"
