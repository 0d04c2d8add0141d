"""A linter finds what is broken, and nothing in what is whole."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
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


def test_what_cannot_be_read_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(LutError, match="cannot be read: no such file"):
        lint(tmp_path / "a.cube")
    with pytest.raises(LutError, match="lint knows"):
        lint(tmp_path / "a.exr")


@pytest.mark.parametrize(("name", "code"), [("jump", 5), ("reversed", 6)])
def test_the_command_tells_and_ends_by_severity(name: str, code: int, tmp_path: Path) -> None:
    file, text, *_ = BROKEN[name]
    (tmp_path / file).write_text(text)
    run = "from facecrf_ocio.cli.lint_command import lint; lint()"
    arguments = [sys.executable, "-c", run, "--json", str(tmp_path / file)]
    ended = subprocess.run(arguments, capture_output=True, text=True, check=False)
    assert ended.returncode == code
    assert json.loads(ended.stdout.splitlines()[0])["path"] == str(tmp_path / file)
