"""The Blender extension, built, installed and used in a real headless Blender."""

import json
import os
import subprocess
import sys
from pathlib import Path

import matplotlib.cbook
import numpy as np
import OpenImageIO as oiio  # noqa: N813
import PyOpenColorIO as ocio  # noqa: N813
import pytest
from host_environments import BLENDERS, CACHE, blender_python

from facecrf_ocio import calibrate, read_photo
from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.estimators import ESTIMATOR_NAMES

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[1]
EXTENSION = ROOT / "nodes" / "blender"
FACECRF = "import sys; from facecrf_ocio.cli.facecrf import main; sys.argv[0] = 'facecrf'; main()"
# A formula, one curve estimated for all channels, and a curve estimated for each.
ESTIMATORS = ("srgb", "joint", "face")
TOLERANCE = 2e-5
ACES, SRGB_IN_ACES = "cg-config-v2.1.0_aces-v1.3_ocio-v2.3", "sRGB - Texture"


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    blender_python()
    folder = tmp_path_factory.mktemp("package")
    subprocess.run([sys.executable, ROOT / "nodes" / "blender_zip.py", folder], check=True)
    return next(folder.glob("facecrf_linearize-*.zip"))


def ran(package, work, estimators, version=BLENDERS[0]):
    """Run the session in a Blender; return its folder and what it said."""
    (work / "photos").mkdir()
    portrait, ramp = work / "photos" / "portrait.png", work / "photos" / "ramp.png"
    original = matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)
    assert oiio.ImageBuf(str(original)).write(str(portrait))
    codes = np.arange(65536).reshape(256, 256, 1) * np.array([1, 7, 13]) % 65536
    assert oiio.ImageBuf(np.ascontiguousarray(codes.astype(np.uint16))).write(str(ramp))
    command = work / "facecrf"
    command.write_text(f"#!{sys.executable}\n{FACECRF}\n")
    command.chmod(0o755)
    script = ROOT / "tests" / "blender_session.py"
    subprocess.run(
        [blender_python(version), script, package, command, work, portrait, ramp, *estimators],
        env={
            **{key: value for key, value in os.environ.items() if key != "OCIO"},
            "PYTHONPATH": str(ROOT),  # for facecrf
            "BLENDER_USER_RESOURCES": str(work / "user"),
        },
        check=True,
        timeout=900,
    )
    return work, json.loads((work / "said.json").read_text())


@pytest.fixture(scope="module")
def session(package, tmp_path_factory):
    return ran(package, tmp_path_factory.mktemp("blender"), ESTIMATORS)


@pytest.fixture(scope="module")
def curves(session):
    photo = read_photo(session[0] / "photos" / "portrait.png")
    found = {name: calibrate(photo, estimator=name).curve for name in ESTIMATORS}
    assert np.ptp(found["face"].linear, axis=0).max() > 0.01, "channels should differ"
    return found


def pixels(path):
    return np.ascontiguousarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[..., :3])


@pytest.mark.parametrize("image", ["portrait", "ramp"])
@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_rendered_pixels_are_those_of_the_library(session, curves, estimator, image):
    codes = read_photo(session[0] / "photos" / f"{image}.png").encoded
    rendered = pixels(session[0] / f"{image}_{estimator}.exr")
    assert np.abs(rendered - curves[estimator].linearize(codes)).max() < TOLERANCE


@pytest.mark.parametrize("version", BLENDERS[1:])
def test_versions_with_long_term_support_render_the_same(package, curves, tmp_path, version):
    work, said = ran(package, tmp_path, ESTIMATORS[-1:], version)
    assert said["version"].startswith(version)
    codes = read_photo(work / "photos" / "ramp.png").encoded
    expected = curves[ESTIMATORS[-1]].linearize(codes)
    rendered = pixels(work / f"ramp_{ESTIMATORS[-1]}.exr")
    assert np.abs(rendered - expected).max() < TOLERANCE
    assert (pixels(work / f"reloaded_{ESTIMATORS[-1]}.exr") == rendered).all()
    assert np.abs(pixels(work / "material.exr") - expected).max() < 2 * TOLERANCE
    assert said["kept_space"]
    assert said["repainted"] == pytest.approx([0.25, 0.5, 0.75], abs=1 / 255)
    painted = decode_srgb(np.array(said["painted_codes"])).tolist()
    assert said["painted"] == pytest.approx(painted, abs=2e-6)
    assert said["left"] == []


def test_the_curve_stays_in_the_file_and_renders_without_the_extension(session):
    reloaded, before = (
        session[0] / f"{name}_{ESTIMATORS[-1]}.exr" for name in ("reloaded", "ramp")
    )
    assert (pixels(reloaded) == pixels(before)).all()


def test_a_material_shows_what_the_library_computes(session, curves):
    """Cycles draws a curve by samples of its own, which miss by a few more 1e-6."""
    codes = read_photo(session[0] / "photos" / "ramp.png").encoded
    rendered = pixels(session[0] / "material.exr")
    assert np.abs(rendered - curves[ESTIMATORS[-1]].linearize(codes)).max() < 2 * TOLERANCE


def test_the_image_keeps_its_color_space_since_others_may_use_it(session):
    assert session[1]["kept_space"]
    assert session[1]["copy_is_data"]


def test_nodes_of_a_second_photo_stand_below_the_first_one_s(session):
    first, second = session[1]["places"]
    assert second <= first - 300
    kinds = ["CompositorNodeImage", "CompositorNodeGroup"]
    assert session[1]["frames"] == [["portrait.png", kind] for kind in kinds] * 2


def test_packed_and_painted_images_need_no_file(session):
    assert session[1]["packed"] == ""
    expected = decode_srgb(np.array(session[1]["painted_codes"]))
    assert session[1]["painted"] == pytest.approx(expected.tolist(), abs=2e-6)
    assert session[1]["made_space"] == "Linear Rec.709"


def test_what_was_painted_on_a_photo_comes_along_and_stays_unsaved(session):
    assert session[1]["repainted"] == pytest.approx([0.25, 0.5, 0.75], abs=1 / 255)
    assert session[1]["still_dirty"]


def test_estimators_are_a_list_of_all_there_are(session):
    assert tuple(session[1]["estimators"]) == ESTIMATOR_NAMES


def test_panel_and_node_are_called_linearize_photo(session):
    assert session[1]["panel"] == session[1]["node"] == "Linearize Photo"
    assert any("facecrf_linearize" in module for module in session[1]["menu"])


@pytest.mark.parametrize("operator", ["missing", "missing_for_folder"])
def test_a_missing_command_is_named_with_what_to_do(session, operator):
    assert "/nowhere/facecrf" in session[1][operator]
    assert "Preferences" in session[1][operator]
    assert not (session[0] / "none").exists()


def test_what_cannot_be_calibrated_is_said(session):
    assert "load it first" in session[1]["unloaded"]
    assert "is not a Linearize Photo node" in session[1]["unlinked"]


def test_a_folder_becomes_exr_files_with_the_pixels_of_the_library(session):
    assert session[1]["folder"] == ["FINISHED"]
    for name in ("portrait", "ramp"):
        photo = read_photo(session[0] / "photos" / f"{name}.png")
        expected = calibrate(photo, estimator="srgb").curve.linearize(photo.encoded)
        written = pixels(session[0] / "exr" / f"{name}.png.exr")
        assert (written == expected.astype(np.float16)).all()


def test_nothing_stays_registered(session):
    assert session[1]["left"] == []


@pytest.mark.parametrize("what", ["source", "package"])
def test_the_extension_is_valid(package, what):
    tool = next(CACHE.rglob("bl_pkg/cli/blender_ext.py"))
    place = EXTENSION if what == "source" else package
    subprocess.run([blender_python(), tool, "validate", place], check=True)


@pytest.mark.parametrize("merged", [False, True], ids=["a config of its own", "Blender's config"])
def test_extension_and_own_config_agree_in_one_blender(package, session, tmp_path, merged):
    """Blender runs with the config that `ocio-config` wrote, alone or added to Blender's own."""
    portrait, command = session[0] / "photos" / "portrait.png", session[0] / "facecrf"
    named = ["--estimator", "srgb", "--formats", "spi1d", "-o", tmp_path / "luts"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    environment.pop("OCIO", None)
    subprocess.run([command, "calibrate", portrait, *named], env=environment, check=True)
    config, how = tmp_path / "own.ocio", []
    if merged:
        how = ["--merge", next(CACHE.glob("bpy-5*/lib/*/*/bpy/*/datafiles/*/config.ocio"))]
    lut = tmp_path / "luts" / "portrait.png.spi1d"
    writing = [command, "ocio-config", lut, "-o", config, *how]
    subprocess.run(writing, env=environment, check=True)
    script = ROOT / "tests" / "blender_extension_config_session.py"
    spaces = tuple(ocio.Config.CreateFromFile(str(config)).getColorSpaceNames())
    (space,) = (name for name in spaces if "portrait" in name and "encode" not in name)
    subprocess.run(
        [blender_python(), script, package, command, tmp_path, portrait, space],
        env={**environment, "OCIO": str(config), "BLENDER_USER_RESOURCES": str(tmp_path / "user")},
        check=True,
        timeout=300,
    )
    expected = decode_srgb(read_photo(portrait).encoded)
    for name in ("extension", "space"):
        assert np.abs(pixels(tmp_path / f"{name}.exr") - expected).max() < TOLERANCE, name
    said = json.loads((tmp_path / "said.json").read_text())
    assert said["made"] == pytest.approx(expected[-1, 0].tolist(), abs=1e-6)  # rows go upward
    assert said["made_space"] in spaces


def test_under_an_aces_config_light_is_in_acescg(package, session, tmp_path):
    """A matrix follows the curve there; Blender's own way from sRGB is the measure."""
    config = ocio.Config.CreateFromBuiltinConfig(ACES)
    (tmp_path / "aces.ocio").write_text(config.serialize())
    script = ROOT / "tests" / "blender_extension_config_session.py"
    portrait, command = session[0] / "photos" / "portrait.png", session[0] / "facecrf"
    subprocess.run(
        [blender_python(), script, package, command, tmp_path, portrait, SRGB_IN_ACES],
        env={
            **os.environ,
            "PYTHONPATH": str(ROOT),
            "OCIO": str(tmp_path / "aces.ocio"),
            "BLENDER_USER_RESOURCES": str(tmp_path / "user"),
        },
        check=True,
        timeout=900,
    )
    expected = np.ascontiguousarray(read_photo(portrait).encoded)
    config.getProcessor(SRGB_IN_ACES, "ACEScg").getDefaultCPUProcessor().applyRGB(expected)
    assert np.abs(expected - decode_srgb(read_photo(portrait).encoded)).max() > 0.05
    for name in ("extension", "space"):
        assert np.abs(pixels(tmp_path / f"{name}.exr") - expected).max() < 2 * TOLERANCE, name
    assert json.loads((tmp_path / "said.json").read_text())["made_space"] == "ACEScg"
