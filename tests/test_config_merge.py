"""A config that photos are added to goes on doing all that it did."""

from __future__ import annotations

import shutil
import site
from pathlib import Path

import numpy as np
import PyOpenColorIO as ocio  # noqa: N813
import pytest
from command_line import CommandLine
from config_spaces import lost, read
from host_environments import CACHE
from lut_files import CURVE, MIXES, REC709_TO_AP1, matrix, through_ocio, write_clf
from photo_files import GRID

from facecrf_ocio.color.primaries import known_primaries
from facecrf_ocio.color.working_space import working_space_matrix
from facecrf_ocio.errors import LutError, SettingsError
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.ocio_config import write_config
from facecrf_ocio.record.outputs import write_outputs
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Confidence, Estimate, InverseCRF, Outcome, Photo, Verdict

GAMMA = InverseCRF(GRID, np.stack([GRID**2.2] * 3))
BUILT_IN = [name for name, *_ in ocio.BuiltinConfigRegistry().getBuiltinConfigs()]
BLENDERS = "bpy/*/datafiles/colormanagement/config.ocio"
STUDIO = """ocio_profile_version: 2
{search}
environment: {{SHOT: one, PLACE: luts}}
roles: {{scene_linear: lin, default: lin, aces_interchange: lin}}
displays: {{d: [!<View> {{name: v, colorspace: looked}}]}}
colorspaces:
  - !<ColorSpace> {{name: lin}}
  - !<ColorSpace>
    name: looked
    from_scene_reference: !<FileTransform> {{src: "{src}"}}
"""


@pytest.fixture
def lut(tmp_path: Path) -> Path:
    (tmp_path / "in").mkdir()
    return write_lut(GAMMA, tmp_path / "in" / "p.spi1d")


def studio(folder: Path, search: str, src: str) -> Path:
    (folder / "luts" / "one").mkdir(parents=True)
    look = write_lut(InverseCRF(GRID, np.stack([GRID**3.0] * 3)), folder / "luts" / "look.spi1d")
    shutil.copy(look, folder / "luts" / "one" / "shot.spi1d")
    (folder / "studio.ocio").write_text(STUDIO.format(search=search, src=src))
    return folder / "studio.ocio"


@pytest.mark.parametrize("where", ["in its own folder", "into another"])
@pytest.mark.parametrize(
    ("search", "src"),
    [
        ("", "luts/look.spi1d"),
        ("search_path: luts", "look.spi1d"),
        ("search_path: ['.', luts]", "look.spi1d"),
        ("search_path: $PLACE", "look.spi1d"),
        ("search_path: luts/$SHOT", "shot.spi1d"),
        ("search_path: '${PLACE}/${SHOT}'", "shot.spi1d"),
        ("", "luts/${SHOT}/shot.spi1d"),
    ],
)
def test_every_space_goes_on(search: str, src: str, where: str, lut: Path, tmp_path: Path) -> None:
    before = studio(tmp_path / "a studio", search, src)
    after = (before.parent if "own" in where else tmp_path) / "new.ocio"
    write_config([lut], after, merge=str(before))
    count, unlike = lost(read(before), read(after))
    assert (count, unlike) == (5, [])
    assert "facecrf_p" in read(after).getColorSpaceNames()


def test_a_path_that_begins_with_an_absolute_variable_goes_on(
    lut: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = studio(tmp_path / "studio", "search_path: $STUDIO/luts", "look.spi1d")
    # A config that lists variables knows no others.
    text = before.read_text().replace("environment: {SHOT: one, PLACE: luts}\n", "")
    before.write_text(text)
    monkeypatch.setenv("STUDIO", str(tmp_path / "studio"))
    write_config([lut], tmp_path / "new.ocio", merge=str(before))
    assert lost(read(before), read(tmp_path / "new.ocio")) == (5, [])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["default", *BUILT_IN])
def test_built_in_configs_go_on_in_their_own_version(
    name: str, lut: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "new.ocio"
    ended = CommandLine(capfd)("ocio-config", lut, "-o", output, "--merge", f"ocio://{name}")
    assert ended.code == 0
    before, after = read(f"ocio://{name}"), read(output)
    versions = [(c.getMajorVersion(), c.getMinorVersion()) for c in (before, after)]
    assert versions[0] == versions[1]
    told = f"its profile version stays {versions[0][0]}.{versions[0][1]}"
    assert told in ended.out
    assert ("newer than Blender 5.0 reads" in ended.out) == (versions[0] > (2, 4))
    count, unlike = lost(before, after)
    print(f"{name}: {count} ways unchanged")
    assert unlike == []
    assert count >= len(before.getColorSpaceNames())
    to_acescg = working_space_matrix(None, "acescg")
    pixels = np.full((1, 3), 0.5, np.float32)
    after.getProcessor("facecrf_p", "ACEScg").getDefaultCPUProcessor().applyRGB(pixels)
    assert np.allclose(pixels, to_acescg @ np.full(3, 0.5**2.2), atol=1e-4)


def test_profile_1_is_told_the_way(lut: Path, tmp_path: Path) -> None:
    old = ocio.Config()
    old.setVersion(1, 0)
    (tmp_path / "old.ocio").write_text(
        "ocio_profile_version: 1\nroles: {default: raw, scene_linear: raw}\n"
        "displays: {d: [!<View> {name: v, colorspace: raw}]}\n"
        "colorspaces: [!<ColorSpace> {name: raw}]\n"
    )
    with pytest.raises(SettingsError, match=r"has profile version 1; .*upgradeToLatestVersion"):
        write_config([lut], tmp_path / "n.ocio", merge=str(tmp_path / "old.ocio"))
    upgraded = read(tmp_path / "old.ocio")
    upgraded.upgradeToLatestVersion()
    (tmp_path / "two.ocio").write_text(upgraded.serialize())
    merge = str(tmp_path / "two.ocio")
    write_config([lut], tmp_path / "n.ocio", merge=merge, reference="lin_rec709")
    assert "facecrf_p" in read(tmp_path / "n.ocio").getColorSpaceNames()


def blender_configs() -> list[Path]:
    """The configs that Blender's wheels bring, here or in the hosts' environments."""
    folders = [Path(folder) for folder in site.getsitepackages()]
    folders += sorted(CACHE.glob("bpy-*/lib/python*/site-packages"))
    found = [path for folder in folders for path in sorted(folder.glob(BLENDERS))]
    if not found:
        pytest.skip("Blender's config is not here; install bpy into an environment of its own")
    return found


@pytest.mark.slow
def test_blenders_own_configs_go_on(lut: Path, tmp_path: Path) -> None:
    for before in blender_configs():
        output = tmp_path / "new.ocio"
        if read(before).getMajorVersion() < 2:
            with pytest.raises(SettingsError, match="has profile version 1"):
                write_config([lut], output, merge=str(before))
            continue
        reference = None if read(before).hasRole("aces_interchange") else "lin_rec709"
        write_config([lut], output, merge=str(before), reference=reference, overwrite=True)
        after = read(output)
        count, unlike = lost(read(before), after)
        assert unlike == [], before
        assert count > 60
        print(f"{before}: {count} ways unchanged")
        assert "Non-Color" in after.getColorSpaceNames()
        assert "AgX" in after.getViews("sRGB")
        pixels = np.full((1, 3), 0.5, np.float32)
        to_linear = after.getProcessor("facecrf_p", "scene_linear")
        to_linear.getDefaultCPUProcessor().applyRGB(pixels)
        assert np.allclose(pixels, 0.5**2.2, atol=1e-4)


class TestDescriptions:
    def test_say_what_the_record_tells(self, tmp_path: Path) -> None:
        sigma = np.full((3, GRID.size), 0.02)
        confidence = Confidence(sigma, sigma, Verdict.WEAK, ("few faces",))
        estimate = Estimate(
            Outcome.CALIBRATED, "joint", "found", found=GAMMA, confidence=confidence
        )
        p3 = known_primaries("Display P3", "ICC profile")
        photo = Photo(np.zeros((2, 3, 3), np.float32), path=Path("a.jpg"), primaries=p3)
        write_outputs(photo, estimate, Settings(), tmp_path / "luts", ["spi1d"])
        write_config([tmp_path / "luts"], tmp_path / "c.ocio")
        told = read(tmp_path / "c.ocio").getColorSpace("facecrf_a.jpg").getDescription()
        assert told.splitlines() == [
            "Source: a.jpg, through a.jpg.spi1d.",
            "Curve: calibrated by joint, weak.",
            "A first guess: expect errors about 2 % of white; sRGB would do as well.",
            "Primaries: Display P3 by ICC profile. Exposure: relative, known up to one factor.",
        ]

    def test_of_a_lut_without_a_record(self, lut: Path, tmp_path: Path) -> None:
        write_config([lut], tmp_path / "c.ocio")
        told = read(tmp_path / "c.ocio").getColorSpace("facecrf_p").getDescription()
        assert "taken for Rec.709" in told


class TestWhereLutsLead:
    """The rule of `apply`."""

    def test_by_their_own_matrix(self, tmp_path: Path) -> None:
        lut = write_clf(tmp_path / "a.clf", CURVE, matrix(REC709_TO_AP1))
        write_config([lut], tmp_path / "c.ocio", space="acescg")
        pixels = np.array([[0.5, 0.5, 1.0]], np.float32)
        config = read(tmp_path / "c.ocio")
        config.getProcessor("facecrf_a", "ACEScg").getDefaultCPUProcessor().applyRGB(pixels)
        wanted = np.reshape(REC709_TO_AP1, (3, 3)) @ [0.21, 0.21, 1.0]
        assert np.allclose(pixels[0], wanted, atol=1e-4)

    def test_those_that_lead_nowhere_known_are_refused(self, tmp_path: Path) -> None:
        lut = write_clf(tmp_path / "a.clf", CURVE, matrix(MIXES))
        with pytest.raises(LutError, match="mixes channels and does not say which RGB"):
            write_config([lut], tmp_path / "c.ocio")
        primaries = known_primaries("Rec.709", "assumed")
        write_config([lut], tmp_path / "c.ocio", primaries=primaries)

    def test_a_solid_is_interpolated_as_by_apply(self, tmp_path: Path) -> None:
        blue, green, red = np.meshgrid(*[np.linspace(0, 1, 3)] * 3, indexing="ij")
        rows = np.stack([red * green, green * blue, blue * red * red], axis=-1).reshape(-1, 3)
        text = "\n".join(" ".join(f"{v:.6f}" for v in row) for row in rows)
        lut = tmp_path / "a.cube"
        lut.write_text(f"LUT_3D_SIZE 3\n{text}\n")
        pixels = np.random.default_rng(0).random((4, 8, 3), np.float32)
        expected = through_ocio(lut, pixels)
        write_config([lut], tmp_path / "c.ocio", primaries=known_primaries("Rec.709", "assumed"))
        to_linear = read(tmp_path / "c.ocio").getProcessor("facecrf_a", "lin_rec709")
        to_linear.getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS).applyRGB(pixels)
        assert pixels == pytest.approx(expected, abs=2e-6)

    def test_one_that_opencolorio_does_not_pack(self, lut: Path, tmp_path: Path) -> None:
        odd = lut.rename(lut.with_suffix(".txt"))
        with pytest.raises(SettingsError, match=r"packs no facecrf_p\.txt; give the LUT its suf"):
            write_config([odd], tmp_path / "c.ocioz")
        assert not (tmp_path / "c.ocioz").exists()
        write_config([odd], tmp_path / "c.ocio")

    def test_those_that_encode_are_refused(self, tmp_path: Path) -> None:
        lut = write_lut(GAMMA, tmp_path / "a.cube", direction="encode")
        with pytest.raises(LutError, match="it encodes, by the shape of its curve"):
            write_config([lut], tmp_path / "c.ocio")


FLAWS = {
    "role": ("roles: {default: raw, scene_linear: gone}", "is not defined"),
    "rule": (
        "file_rules: [!<Rule> {name: Default, colorspace: gone}]\nroles: {default: raw}",
        "neither a color space",
    ),
    "look": ("roles: {default: raw}\nlooks: []", "refers to a look"),
}


@pytest.mark.parametrize("name", FLAWS)
def test_a_flaw_is_told_of_the_config_that_has_it(
    name: str, lut: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    said, told = FLAWS[name]
    looks = ", looks: gone" if name == "look" else ""
    (tmp_path / "flawed.ocio").write_text(
        f"ocio_profile_version: 2\n{said}\n"
        f"displays: {{s: [!<View> {{name: Raw, colorspace: raw{looks}}}]}}\n"
        "colorspaces: [!<ColorSpace> {name: raw}]\n"
    )
    with pytest.raises(SettingsError, match=rf"flawed\.ocio: has a flaw.*{told}.*; mend it first"):
        write_config(
            [lut], tmp_path / "new.ocio", merge=str(tmp_path / "flawed.ocio"), reference="acescg"
        )
    assert capfd.readouterr().err == ""
    assert not (tmp_path / "new.ocio").exists()


MERGED = """ocio_profile_version: 2
description: {about}
search_path: luts
roles: {{scene_linear: lin, default: raw, aces_interchange: {interchange}}}
displays: {{d: [!<View> {{name: v, colorspace: looked}}]}}
colorspaces:
  - !<ColorSpace> {{name: lin}}
  - !<ColorSpace> {{name: raw, isdata: true}}
  - !<ColorSpace> {{name: looked, from_scene_reference: !<FileTransform> {{src: look.spi1d}}}}
"""


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (MERGED.format(about="café", interchange="lin").encode("latin-1"), "not UTF-8; save it"),
        (b'\x80\xff"\\\x97', "not a config"),  # which makes OpenColorIO quote what is no text
        (MERGED.format(about="a", interchange="raw").encode(), "is no scene light; pass --refer"),
    ],
)
def test_a_config_that_cannot_be_extended(
    content: bytes, told: str, lut: Path, tmp_path: Path, facecrf: CommandLine
) -> None:
    (tmp_path / "c.ocio").write_bytes(content)
    ended = facecrf("ocio-config", lut, "--merge", tmp_path / "c.ocio", "-o", tmp_path / "n.ocio")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert told in ended.err


@pytest.mark.parametrize("name", ["a.ocioz", "a.ocio"])
def test_a_packed_config_is_known_by_its_content(
    name: str, lut: Path, tmp_path: Path, facecrf: CommandLine
) -> None:
    studio(tmp_path / "s", "search_path: luts", "look.spi1d")
    read(tmp_path / "s" / "studio.ocio").archive(str(tmp_path / "packed.ocioz"))
    (tmp_path / "packed.ocioz").rename(tmp_path / name)
    ended = facecrf("ocio-config", lut, "--merge", tmp_path / name, "-o", tmp_path / "n.ocio")
    assert ended.code == 2
    assert "is packed; unpack it" in ended.err
