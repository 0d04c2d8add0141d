"""Configs of many photos: pixels through them equal the LUTs, whatever the photos are called."""

from __future__ import annotations

import copy
import shutil
import subprocess

import numpy as np
import PyOpenColorIO as ocio  # noqa: N813
import pytest

from facecrf_ocio.errors import LutError, OutputError, SettingsError
from facecrf_ocio.export.working_space import working_space_matrix
from facecrf_ocio.ocio_config import VARIABLE_SPACE, name_luts, write_config

ODD = ["plain", "two words", 'it\'s "quoted"', "$HOME", "%d 100%", "déjà vu 写真", "-o", "a(1)[2]+"]
CODES = np.repeat(np.linspace(0.0, 1.0, 257, dtype=np.float32)[:, None], 3, axis=1)


def write_spi1d(path, gamma):
    path.parent.mkdir(exist_ok=True, parents=True)
    rows = "".join(f"{v:.9g}\n" for v in np.linspace(0, 1, 4096) ** gamma)
    path.write_text(f"Version 1\nFrom 0 1\nLength 4096\nComponents 1\n{{\n{rows}}}\n")
    return path


def through(config, source, target, context=None):
    context = context or config.getCurrentContext()
    pixels = CODES.copy()
    processor = config.getProcessor(context, source, target)
    processor.getOptimizedCPUProcessor(ocio.OptimizationFlags.OPTIMIZATION_LOSSLESS).applyRGB(
        pixels
    )
    return pixels


def expected(gamma):
    return np.interp(CODES, np.linspace(0, 1, 4096), np.linspace(0, 1, 4096) ** gamma)


@pytest.mark.parametrize("suffix", [".ocio", ".ocioz"])
def test_each_photo_goes_through_its_own_curve_by_its_name(tmp_path, suffix):
    gammas = {stem: 1.5 + 0.1 * number for number, stem in enumerate(ODD)}
    for stem, gamma in gammas.items():
        write_spi1d(tmp_path / "in" / f"{stem}.spi1d", gamma)
    output = tmp_path / f"config{suffix}"
    write_config([tmp_path / "in"], output)
    shutil.rmtree(tmp_path / "in")
    config = ocio.Config.CreateFromFile(str(output))
    config.validate()
    for stem, gamma in gammas.items():
        space, _ = config.getColorSpaceFromFilepath(f"/photos/{stem}.jpg")
        assert config.getColorSpace(space).getEncoding() == "sdr-video"
        assert np.abs(through(config, space, "scene_linear") - expected(gamma)).max() < 1e-6
    assert config.getColorSpaceFromFilepath("/photos/other plain.jpg")[0] == "default"


def test_two_photos_of_one_name_are_told_apart_by_their_folders(tmp_path):
    luts = [write_spi1d(tmp_path / folder / "p.spi1d", g) for folder, g in (("a", 1.8), ("b", 2.4))]
    write_config(luts, tmp_path / "config.ocio")
    config = ocio.Config.CreateFromFile(str(tmp_path / "config.ocio"))
    for folder, gamma in (("a", 1.8), ("b", 2.4)):
        space, _ = config.getColorSpaceFromFilepath(f"/x/{folder}/p.png")
        assert np.abs(through(config, space, "scene_linear") - expected(gamma)).max() < 1e-6


def test_names_differ_even_without_regard_to_case(tmp_path):
    entries = name_luts([tmp_path / "A b.spi1d", tmp_path / "a_b.spi1d", tmp_path / "a$b.spi1d"])
    assert len({entry.name.lower() for entry in entries}) == 3


@pytest.mark.parametrize("suffix", [".ocio", ".ocioz"])
def test_a_context_variable_chooses_the_photo_and_has_a_default(tmp_path, suffix):
    lut = write_spi1d(tmp_path / "in" / "p.spi1d", 2.2)
    output = tmp_path / f"config{suffix}"
    write_config([lut], output, form="variable")
    config = ocio.Config.CreateFromFile(str(output))
    context = copy.deepcopy(config.getCurrentContext())
    context["FACECRF_PHOTO"] = "p"
    photo = through(config, VARIABLE_SPACE, "scene_linear", context)
    assert np.abs(photo - expected(2.2)).max() < 1e-6
    assert config.getEnvironmentVarDefault("FACECRF_PHOTO") == "default_srgb"
    unset = through(config, VARIABLE_SPACE, "scene_linear")
    assert np.abs(unset - through(config, "srgb", "scene_linear")).max() < 1e-6


@pytest.mark.parametrize("suffix", [".ocio", ".ocioz"])
def test_a_built_in_aces_config_keeps_its_roles_and_rules(tmp_path, suffix):
    name = "ocio://cg-config-v1.0.0_aces-v1.3_ocio-v2.1"
    lut = write_spi1d(tmp_path / "in" / "p.spi1d", 2.2)
    write_config([lut], tmp_path / f"config{suffix}", merge=name)
    merged = ocio.Config.CreateFromFile(str(tmp_path / f"config{suffix}"))
    before = ocio.Config.CreateFromFile(name)
    assert list(merged.getRoles()) == list(before.getRoles())
    rules, former = merged.getFileRules(), before.getFileRules()
    kept = [rules.getName(i) for i in range(1, rules.getNumEntries())]
    assert kept == [former.getName(i) for i in range(former.getNumEntries())]
    wanted = expected(2.2) @ working_space_matrix(None, "acescg").T
    assert np.abs(through(merged, "facecrf_p", "ACEScg") - wanted).max() < 1e-6


def test_a_studio_config_finds_its_own_luts_from_its_new_folder(tmp_path):
    studio = tmp_path / "studio"
    write_spi1d(studio / "luts" / "log.spi1d", 3.0)
    (studio / "config.ocio").write_text(
        "ocio_profile_version: 2\nsearch_path: luts\nroles:\n  default: raw\n"
        "  scene_linear: lin\nfile_rules:\n"
        "  - !<Rule> {name: jpegs, pattern: '*', extension: jpg, colorspace: log}\n"
        "  - !<Rule> {name: Default, colorspace: default}\n"
        "displays:\n  d:\n    - !<View> {name: v, colorspace: raw}\ncolorspaces:\n"
        "  - !<ColorSpace> {name: raw, isdata: true}\n  - !<ColorSpace> {name: lin}\n"
        "  - !<ColorSpace> {name: log, to_scene_reference: !<FileTransform> {src: log.spi1d}}\n"
    )
    lut = write_spi1d(tmp_path / "in" / "p.spi1d", 2.2)
    with pytest.raises(SettingsError, match="--reference"):
        write_config([lut], tmp_path / "new.ocio", merge=str(studio / "config.ocio"))
    write_config(
        [lut],
        tmp_path / "new.ocio",
        merge=str(studio / "config.ocio"),
        reference="lin_rec709",
    )
    config = ocio.Config.CreateFromFile(str(tmp_path / "new.ocio"))
    assert np.abs(through(config, "log", "lin") - expected(3.0)).max() < 1e-6
    assert config.getColorSpaceFromFilepath("x/p.jpg")[0] == "facecrf_p"
    assert config.getColorSpaceFromFilepath("x/q.jpg")[0] == "log"


def test_oiiotool_converts_through_the_config(tmp_path):
    oiio = pytest.importorskip("OpenImageIO")
    tool = shutil.which("oiiotool")
    if tool is None:
        pytest.skip("no oiiotool")
    lut = write_spi1d(tmp_path / "in" / "p.spi1d", 2.2)
    write_config([lut], tmp_path / "config.ocio")
    image = oiio.ImageBuf(np.ascontiguousarray(CODES[None]))
    image.write(str(tmp_path / "codes.exr"))
    subprocess.run(
        [
            tool,
            "--colorconfig",
            tmp_path / "config.ocio",
            tmp_path / "codes.exr",
            "--colorconvert",
            "facecrf_p",
            "lin_rec709",
            "-d",
            "float",
            "-o",
            tmp_path / "out.exr",
        ],
        check=True,
    )
    result = oiio.ImageBuf(str(tmp_path / "out.exr")).get_pixels(oiio.FLOAT)[0]
    assert np.abs(result - expected(2.2)).max() < 1e-6


def test_nothing_is_replaced_and_nothing_is_left_half_written(tmp_path):
    lut = write_spi1d(tmp_path / "in" / "p.spi1d", 2.2)
    output = tmp_path / "config.ocio"
    write_config([lut], output)
    before = output.read_bytes()
    with pytest.raises(OutputError, match="--overwrite"):
        write_config([lut], output)
    write_config([lut], output, overwrite=True)
    assert output.read_bytes() == before
    with pytest.raises(OutputError, match="cannot be written"):
        write_config([lut], tmp_path / "missing" / "config.ocio")
    with pytest.raises(LutError, match="does not exist"):
        write_config([tmp_path / "none.spi1d"], tmp_path / "other.ocio")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["config.ocio", "config_luts", "in"]
