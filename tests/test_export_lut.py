"""LUT files, read by readers other than the one that wrote them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813
import PyOpenColorIO as ocio  # noqa: N813
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from facecrf_ocio.errors import LutError, OutputError, SettingsError
from facecrf_ocio.lut.format_table import FORMATS
from facecrf_ocio.lut.ocio_processor import exact_cpu, ocio_processor
from facecrf_ocio.lut.read_back import require_curve
from facecrf_ocio.lut.transform import LutTransform
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.values import InverseCRF

NODES = np.linspace(0.0, 1.0, 4096)
HOSTILE_TEXT = (
    "a -- b --> ]]> <x> & \"q\" 'é 日本 🙂'\nFrom 1 0\n}\n\x00\x0b\x1b\u2028\ufffe\udcff" * 40
)

every_format = pytest.mark.parametrize(
    "suffix", ["spi1d", "cube", "iridas.cube", "clf", "ctf", "csp"]
)


def curve_of(*channels: npt.NDArray[np.float64], encoded: npt.ArrayLike = NODES) -> InverseCRF:
    return InverseCRF(np.asarray(encoded), np.stack(channels * (3 // len(channels))))


def near_flat_start() -> npt.NDArray[np.float64]:
    curve = np.where(NODES < 0.3, 1e-12 * NODES, 0.0) + np.clip((NODES - 0.3) / 0.7, 0, None) ** 2
    return np.asarray(curve / curve[-1])


EXTREME = {
    "gammas 4, 1, 0.25": curve_of(NODES**4, NODES, NODES**0.25),
    "near-flat start": curve_of(near_flat_start()),
    "a jump near white": curve_of((NODES + (NODES > 0.98)) / 2),
    "below float32": curve_of(NODES**15),
    "two samples": curve_of(np.array([0.0, 1.0]), encoded=[0.0, 1.0]),
    "unevenly sampled": curve_of(np.array([0.0, 0.01, 0.5, 1.0]), encoded=[0.0, 0.3, 0.7, 1.0]),
    "finer than the LUT": curve_of(
        np.linspace(0, 1, 20001) ** 2.2, encoded=np.linspace(0, 1, 20001)
    ),
}


def numbers(lines: list[str]) -> npt.NDArray[np.float32]:
    return np.array([[np.float32(word) for word in line.split()] for line in lines])


def read_spi1d(path: Path) -> npt.NDArray[np.float32]:
    head, _, rest = path.read_text("ascii").partition("{\n")
    table, closing, _ = rest.partition("}\n")
    assert head.split() == ["Version", "1", "From", "0", "1", "Length", "4096", "Components", "3"]
    assert closing
    return numbers(table.splitlines())


def read_cube(path: Path) -> npt.NDArray[np.float32]:
    lines = [line for line in path.read_text("ascii").splitlines() if not line.startswith("#")]
    assert lines[:2] == ["LUT_1D_SIZE 4096", "LUT_1D_INPUT_RANGE 0 1"]
    return numbers(lines[2:])


def read_iridas_cube(path: Path) -> npt.NDArray[np.float32]:
    """By Adobe's Cube LUT Specification 1.0: keywords in any order, then the table."""
    content = path.read_bytes()
    assert all(len(line) <= 250 for line in content.splitlines(keepends=True))
    lines = [line for line in content.decode("ascii").splitlines() if not line.startswith("#")]
    assert lines[0].startswith('TITLE "')
    assert lines[0].endswith('"')
    assert lines[1:4] == ["DOMAIN_MIN 0 0 0", "DOMAIN_MAX 1 1 1", "LUT_1D_SIZE 4096"]
    return numbers(lines[4:])


def read_clf(path: Path) -> npt.NDArray[np.float32]:
    return read_xml(path, "compCLFversion", "3")


def read_ctf(path: Path) -> npt.NDArray[np.float32]:
    return read_xml(path, "version", "1.3")


def read_csp(path: Path) -> npt.NDArray[np.float32]:
    head, _, rest = path.read_text("ascii").partition("END METADATA\n\n")
    assert head.splitlines()[:4] == ["CSPLUTV100", "1D", "", "BEGIN METADATA"]
    shapers, length, table = rest.partition("\n4096\n")
    assert shapers.split() == ["2", "0", "1", "0", "1"] * 3
    assert length
    return numbers(table.splitlines())


def read_xml(path: Path, key: str, version: str) -> npt.NDArray[np.float32]:
    root = ElementTree.parse(path).getroot()  # noqa: S314 - our own file
    assert (root.tag, root.get(key)) == ("ProcessList", version)
    (node,) = root.findall("LUT1D")
    assert (node.get("inBitDepth"), node.get("outBitDepth")) == ("32f", "32f")
    (array,) = node.findall("Array")
    assert array.get("dim") == "4096 3"
    return numbers((array.text or "").strip().splitlines())


READERS = {
    "spi1d": read_spi1d,
    "cube": read_cube,
    "iridas.cube": read_iridas_cube,
    "clf": read_clf,
    "ctf": read_ctf,
    "csp": read_csp,
}


def processor(path: Path) -> ocio.CPUProcessor:
    ocio.ClearAllCaches()
    transform = ocio.FileTransform(str(path))
    found = ocio.Config.CreateRaw().getProcessor(
        ocio.Context(), transform, ocio.TRANSFORM_DIR_FORWARD
    )
    return found.getOptimizedCPUProcessor(
        ocio.BIT_DEPTH_F32, ocio.BIT_DEPTH_F32, ocio.OPTIMIZATION_LOSSLESS
    )


def through_ocio(path: Path, codes: npt.ArrayLike) -> npt.NDArray[np.float32]:
    """Return (3, N) what OCIO maps gray codes to."""
    pixels = np.repeat(np.asarray(codes, np.float32)[:, None], 3, axis=1)
    processor(path).applyRGB(pixels)
    return pixels.T


def expected_entries(curve: InverseCRF) -> npt.NDArray[np.float64]:
    return np.stack([np.interp(NODES, curve.encoded, channel) for channel in curve.linear])


@st.composite
def increasing_curves(draw: st.DrawFn) -> InverseCRF:
    """Strictly increasing curves from smooth to staircase, evenly or unevenly sampled."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    size = draw(st.sampled_from([2, 3, 17, 256, 1024, 4096, 6000]))
    smoothness = draw(st.floats(0.02, 20.0))

    def channel(shape: float) -> npt.NDArray[np.float64]:
        steps = rng.gamma(shape, size=size - 1) + 1e-300
        steps = steps / steps.sum() + 1e-11
        values = np.concatenate([[0.0], np.cumsum(steps)])
        return np.asarray(values / values[-1])

    uneven = size != 4096 and draw(st.booleans())
    encoded = channel(5.0) if uneven else np.linspace(0.0, 1.0, size)
    return InverseCRF(encoded, np.stack([channel(smoothness) for _ in range(3)]))


@every_format
@settings(max_examples=12, deadline=None)
@given(curve=increasing_curves())
def test_any_increasing_curve_survives_the_file(
    suffix: str, curve: InverseCRF, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = write_lut(curve, tmp_path_factory.mktemp("lut") / f"curve.{suffix}")
    entries = expected_entries(curve)
    np.testing.assert_array_equal(READERS[suffix](path).T, entries.astype(np.float32))
    # OCIO finds an entry by a float32 code, which is exact to 2**-12 of a step only.
    steps = np.diff(entries, axis=1, prepend=0.0, append=1.0)
    tolerance = 1e-6 + 2.0**-12 * np.maximum(steps[:, 1:], steps[:, :-1])
    assert (np.abs(through_ocio(path, NODES) - entries) <= tolerance).all()


@every_format
@pytest.mark.parametrize("name", EXTREME)
def test_extreme_curves_are_read_by_ocio_as_they_are(
    suffix: str, name: str, tmp_path: Path
) -> None:
    curve = EXTREME[name]
    path = write_lut(curve, tmp_path / f"curve.{suffix}")
    codes = np.float32(np.linspace(0, 1, 50001))
    between = np.stack([np.interp(codes, NODES, entry) for entry in expected_entries(curve)])
    # Between two entries OCIO tells places apart to 2**-13 of their difference near white.
    slack = 2.0**-13 if "jump" in name else 1e-6
    np.testing.assert_allclose(through_ocio(path, codes), between, rtol=0, atol=slack)
    assert (np.diff(READERS[suffix](path), axis=0) >= 0).all()


@every_format
def test_the_first_and_last_entries_are_exactly_black_and_white(
    suffix: str, tmp_path: Path
) -> None:
    path = write_lut(EXTREME["gammas 4, 1, 0.25"], tmp_path / f"curve.{suffix}")
    np.testing.assert_array_equal(READERS[suffix](path)[[0, -1]], [[0, 0, 0], [1, 1, 1]])


@every_format
def test_channels_stand_in_the_order_rgb(suffix: str, tmp_path: Path) -> None:
    path = write_lut(curve_of(NODES**3, NODES**2, NODES), tmp_path / f"curve.{suffix}")
    np.testing.assert_allclose(through_ocio(path, [0.5])[:, 0], [0.125, 0.25, 0.5], atol=1e-6)


@every_format
def test_the_file_agrees_with_the_curves_own_linearize(suffix: str, tmp_path: Path) -> None:
    curve = curve_of(NODES**2.4, NODES**2.2, NODES**1.8)
    path = write_lut(curve, tmp_path / f"curve.{suffix}")
    codes = np.arange(256) / 255
    own = curve.linearize(np.repeat(codes[:, None], 3, axis=1)).T
    np.testing.assert_allclose(through_ocio(path, codes), own, rtol=0, atol=1e-6)


@every_format
def test_oiiotool_applies_the_file(suffix: str, tmp_path: Path) -> None:
    oiiotool = Path(sys.executable).parent / "oiiotool"
    if not oiiotool.exists():
        pytest.skip("oiiotool is not beside this Python")
    lut_file = write_lut(EXTREME["gammas 4, 1, 0.25"], tmp_path / f"a lut.{suffix}")
    ramp = np.repeat(NODES.astype(np.float32)[None, :, None], 3, axis=2)
    source, result = tmp_path / "ramp.tif", tmp_path / "linear.tif"
    image = oiio.ImageBuf(oiio.ImageSpec(4096, 1, 3, oiio.FLOAT))
    image.set_pixels(oiio.ROI(), ramp)
    assert image.write(str(source))
    arguments = (source, "--ociofiletransform", lut_file, "-d", "float", "-o", result)
    subprocess.run([str(oiiotool), *map(str, arguments)], check=True, capture_output=True)
    pixels = np.asarray(oiio.ImageBuf(str(result)).get_pixels(oiio.FLOAT))
    np.testing.assert_allclose(pixels[0].T, [NODES**4, NODES, NODES**0.25], rtol=0, atol=1e-5)


@every_format
def test_no_remark_can_break_a_file(suffix: str, tmp_path: Path) -> None:
    curve = curve_of(NODES**2)
    remarks = {"Source": HOSTILE_TEXT, HOSTILE_TEXT: "x", "": "", "long": "🙂" * 5000}
    path = write_lut(curve, tmp_path / f"curve.{suffix}", provenance=remarks)
    np.testing.assert_array_equal(READERS[suffix](path).T, expected_entries(curve).astype("f4"))
    assert max(map(len, path.read_bytes().splitlines())) < 4096


def test_remarks_can_be_read_again(tmp_path: Path) -> None:
    remark = {"Source": "Zoë <1> & co.jpg"}
    paths = {s: write_lut(curve_of(NODES), tmp_path / f"a.{s}", provenance=remark) for s in READERS}
    root = ElementTree.parse(paths["clf"]).getroot()  # noqa: S314 - our own file
    assert "Source: Zoë <1> & co.jpg" in [node.text for node in root.findall("Description")]
    assert "# Source: Zo\\xeb <1> & co.jpg" in paths["spi1d"].read_text().splitlines()
    assert "# Source: Zo\\xeb <1> & co.jpg" in paths["cube"].read_text().splitlines()


def test_clf_names_itself_and_what_goes_in_and_out(tmp_path: Path) -> None:
    texts = [write_lut(curve_of(NODES**g), tmp_path / f"{g}.clf").read_text() for g in (2, 3)]
    first, second = map(ElementTree.fromstring, texts)
    assert (first.get("id") or "").startswith("urn:uuid:")
    assert first.get("id") != second.get("id")
    assert first.findtext("Description")
    assert first.findtext("InputDescriptor")
    assert first.findtext("OutputDescriptor")
    metadata = ocio.Config.CreateRaw().getProcessor(ocio.FileTransform(str(tmp_path / "2.clf")))
    assert metadata.getFormatMetadata().getID() == first.get("id")


@every_format
def test_equal_curves_make_equal_files(suffix: str, tmp_path: Path) -> None:
    first, second = (write_lut(curve_of(NODES**2), tmp_path / f"{n}.{suffix}") for n in "ab")
    assert first.read_bytes() == second.read_bytes()


@every_format
@pytest.mark.parametrize(
    "name",
    [
        "a b",
        'it\'s "q"',
        "$HOME",
        "${HOME}x",
        "%HOME%",
        "Zoë 日本",
        "-dash",
        "#a",
        "a\\b",
        "n" * 240,
    ],
)
def test_any_name_of_folder_and_file_will_do(suffix: str, name: str, tmp_path: Path) -> None:
    folder = tmp_path / name
    folder.mkdir()
    path = write_lut(curve_of(NODES**2), folder / f"{name}.{suffix}")
    assert list(folder.iterdir()) == [path]
    assert READERS[suffix](path).shape == (4096, 3)


def test_a_relative_name_with_a_leading_dash_will_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    write_lut(curve_of(NODES**2), Path("-a.spi1d"))
    assert [path.name for path in tmp_path.iterdir()] == ["-a.spi1d"]


def test_capital_suffixes_will_do(tmp_path: Path) -> None:
    path = write_lut(curve_of(NODES**2), tmp_path / "A.CUBE")
    assert through_ocio(path, [0.5])[0, 0] == pytest.approx(0.25, abs=1e-6)


@pytest.mark.parametrize("name", ["a.lut", "a", "a.spi1d.gz", ".cube", "a.exr"])
def test_unknown_formats_are_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(LutError, match=r"unknown LUT format .*; use one of spi1d, cube, clf"):
        write_lut(curve_of(NODES), tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_an_existing_file_stays_unless_overwriting_is_asked_for(tmp_path: Path) -> None:
    path = write_lut(curve_of(NODES**2), tmp_path / "a.spi1d")
    before = path.read_bytes()
    with pytest.raises(OutputError, match=r"a\.spi1d: exists already; pass overwrite=True"):
        write_lut(curve_of(NODES**3), path)
    assert path.read_bytes() == before
    write_lut(curve_of(NODES**3), path, overwrite=True)
    assert through_ocio(path, [0.5])[0, 0] == pytest.approx(0.125, abs=1e-6)
    assert list(tmp_path.iterdir()) == [path]


def test_the_cache_of_ocio_never_shows_the_former_file(tmp_path: Path) -> None:
    def read() -> float:  # without clearing the caches, as a host would
        pixels = np.full((1, 3), 0.5, np.float32)
        transform = ocio.FileTransform(str(tmp_path / "a.spi1d"))
        ocio.Config.CreateRaw().getProcessor(transform).getDefaultCPUProcessor().applyRGB(pixels)
        return float(pixels[0, 0])

    write_lut(curve_of(NODES**2), tmp_path / "a.spi1d")
    assert read() == pytest.approx(0.25, abs=1e-6)
    write_lut(curve_of(NODES**3), tmp_path / "a.spi1d", overwrite=True)
    assert read() == pytest.approx(0.125, abs=1e-6)


DAMAGE = {
    "a wrong entry": lambda text: text.replace("\n0.25", "\n0.26", 1),
    "decimal commas": lambda text: text.replace("0.", "0,"),
    "NaN": lambda text: text.replace("\n0.25", "\nnan ", 1),
    "a missing row": lambda text: text.replace("\n1 1 1\n", "\n", 1),
    "no header": lambda text: text.replace("4096", "", 2),
    "a fourth column": lambda text: text.replace("\n", " 0\n"),
}


@every_format
@pytest.mark.parametrize("damage", DAMAGE)
def test_a_file_that_does_not_read_back_never_appears(
    suffix: str, damage: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    curve = curve_of(NODES**2)
    row = FORMATS[suffix]
    whole = str(row.write(LutTransform(curve), ()))
    damaged = DAMAGE[damage](whole)
    assert damaged != whole
    module, _, function = row.writer.partition(":")
    monkeypatch.setattr(f"{module}.{function}", lambda *_: damaged)
    with pytest.raises(LutError, match=r"a\.[\w.]+: OpenColorIO .*read") as caught:
        write_lut(curve, tmp_path / f"a.{suffix}")
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_a_damaged_file_is_told_beside_a_good_one_of_the_same_curve(tmp_path: Path) -> None:
    curve = curve_of(NODES**2)
    require_curve(write_lut(curve, tmp_path / "a.spi1d"), curve)
    for suffix in ("cube", "clf"):
        path = write_lut(curve, tmp_path / f"a.{suffix}")
        damage = DAMAGE["a wrong entry"]
        path.write_text(damage(path.read_text(encoding="utf-8")), encoding="utf-8")
        with pytest.raises(LutError, match=r"error of 0\.0"):
            require_curve(path, curve)


@pytest.mark.parametrize("suffix", ["cube", "clf", "ctf", "csp"])
def test_the_same_table_has_one_identity_in_all_formats(suffix: str, tmp_path: Path) -> None:
    curve = curve_of(NODES**2)
    one, other = (write_lut(curve, tmp_path / f"a.{name}") for name in ("spi1d", suffix))
    identities = {exact_cpu(ocio_processor(path, curve=True)).getCacheID() for path in (one, other)}
    assert len(identities) == 1


def test_verify_tells_curves_apart(tmp_path: Path) -> None:
    path = write_lut(curve_of(NODES**2.2), tmp_path / "a.clf")
    require_curve(path, curve_of(NODES**2.2))
    bent = NODES**2.2
    bent[2000] += 2e-6
    with pytest.raises(LutError, match=r"error of 1.9\d?e-06|error of 2e-06"):
        require_curve(path, curve_of(bent))


@pytest.mark.parametrize(
    "linear",
    [NODES[::-1], np.where(NODES < 0.5, NODES, np.nan), np.minimum(1, NODES * 2)],
    ids=["reversed", "NaN", "flat top"],
)
def test_what_is_no_inverse_response_cannot_even_be_made(
    linear: npt.NDArray[np.float64],
) -> None:
    with pytest.raises(SettingsError):
        curve_of(linear)
