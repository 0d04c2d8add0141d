"""The Blender extension, used in a real headless Blender that has an environment of its own."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest

from facecrf_ocio import calibrate, read_photo

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[1]
EXTENSION = ROOT / "nodes" / "blender"
PLACE = Path.home() / ".cache" / "facecrf-tests" / "bpy-5.0.1"
FACECRF = "import sys; from facecrf_ocio.cli import main; sys.argv[0] = 'facecrf'; main()"


@pytest.fixture(scope="module")
def blender_python():
    python = PLACE / "bin" / "python"
    if not (PLACE / "ready").is_file():
        base = shutil.which("python3.11")
        if base is None:
            pytest.skip("bpy 5.0 needs Python 3.11, which is not here")
        subprocess.run([base, "-m", "venv", "--clear", str(PLACE)], check=True)
        made = subprocess.run([python, "-m", "pip", "install", "-q", "bpy==5.0.1"], check=False)
        if made.returncode:
            pytest.skip("bpy 5.0.1 cannot be installed from PyPI here")
        (PLACE / "ready").touch()
    return python


@pytest.fixture(scope="module")
def session(blender_python, tmp_path_factory):
    work = tmp_path_factory.mktemp("blender")
    shutil.copytree(EXTENSION, work / "modules" / "facecrf_linearize")
    photo = work / "photos" / "ramp.png"
    photo.parent.mkdir()
    codes = np.arange(256 * 3 * 4).reshape(16, 64, 3) * np.array([1, 7, 13]) % 256
    out = oiio.ImageBuf(np.ascontiguousarray(codes.astype(np.uint8)))
    assert out.write(str(photo))
    command = work / "facecrf"
    command.write_text(f"#!{sys.executable}\n{FACECRF}\n")
    command.chmod(0o755)
    subprocess.run(
        [blender_python, ROOT / "tests" / "blender_session.py", photo, command, work],
        env={
            **os.environ,
            "PYTHONPATH": f"{work}/modules{os.pathsep}{ROOT}",
            "BLENDER_USER_RESOURCES": str(work / "user"),
        },
        check=True,
        timeout=240,
    )
    return work, photo, json.loads((work / "said.json").read_text())


def pixels(path):
    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[..., :3]


@pytest.mark.parametrize("when", ["before", "after"])
def test_rendered_pixels_are_those_of_the_library_also_after_reload(session, when):
    work, photo, _ = session
    source = read_photo(photo)
    expected = calibrate(source, estimator="srgb").curve.linearize(source.encoded)
    assert np.abs(pixels(work / f"{when}.exr") - expected).max() < 2e-5


def test_a_missing_command_is_named_with_what_to_do(session):
    assert "/nowhere/facecrf" in session[2]["missing"]
    assert "preferences" in session[2]["missing"]


def test_a_folder_becomes_exr_files(session):
    assert session[2]["folder"] == ["FINISHED"]
    assert (session[0] / "exr" / "ramp.png.exr").is_file()


def test_nothing_stays_registered(session):
    assert session[2]["left"] == []


def test_the_extension_validates_and_builds(blender_python, tmp_path):
    tool = next(PLACE.rglob("bl_pkg/cli/blender_ext.py"))
    subprocess.run([blender_python, tool, "validate", EXTENSION], check=True)
    build = ["build", "--source-dir", EXTENSION, "--output-dir", tmp_path]
    subprocess.run([blender_python, tool, *build], check=True)
    assert list(tmp_path.glob("facecrf_linearize-*.zip"))
