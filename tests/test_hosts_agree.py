"""One LUT, the same pixels in every host: OpenColorIO of three years, oiiotool, Blender."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import PyOpenColorIO as ocio  # noqa: N813
import pytest
from host_environments import blender_python, host_python
from host_luts import CASES, make_host_luts

from facecrf_ocio.cli.facecrf import main

pytestmark = pytest.mark.slow
HERE = Path(__file__).parent
TOLERANCE = 5e-7  # so any two hosts agree within 1e-6

# A release, and a later one for Pythons that it has no wheel for.
OCIO_RELEASES = {
    "ocio-2.3": ("opencolorio==2.3.2", "opencolorio==2.4.2"),
    "ocio-2.5": ("opencolorio==2.5.1", "opencolorio==2.5.2"),
    "ocio-2.6": ("opencolorio==2.6.0",),
}
each_case = pytest.mark.parametrize("case", CASES, ids="-".join)


@pytest.fixture(scope="module")
def luts(tmp_path_factory):
    return make_host_luts(tmp_path_factory.mktemp("luts"))


def farthest(pixels, luts, case):
    expected = luts.linear[case[0]].reshape(-1, 3)
    assert pixels.size == expected.size
    return np.abs(pixels.reshape(-1, 3) - expected).max()


@pytest.mark.parametrize("release", OCIO_RELEASES)
def test_opencolorio_gives_the_pixels_of_the_library(luts, release, tmp_path):
    python = host_python(release, *OCIO_RELEASES[release])
    (tmp_path / "codes").write_bytes(luts.codes.tobytes())
    session = [python, HERE / "ocio_session.py", tmp_path / "codes", tmp_path / "out", *luts.files]
    said = subprocess.run(session, check=True, capture_output=True, text=True)
    assert f"opencolorio=={said.stdout.strip()}" in OCIO_RELEASES[release]
    results = np.fromfile(tmp_path / "out", np.float32).reshape(len(CASES), -1)
    for case, pixels in zip(CASES, results, strict=True):
        assert farthest(pixels, luts, case) < TOLERANCE, case


@pytest.fixture(scope="module")
def oiiotool():
    beside = Path(sys.executable).parent / "oiiotool"
    found = str(beside) if beside.is_file() else shutil.which("oiiotool")
    if found is None:
        pytest.skip("the OpenImageIO package here brings no oiiotool")
    return found


@each_case
def test_oiiotool_gives_the_pixels_of_the_library(luts, oiiotool, case, tmp_path):
    lut = luts.files[CASES.index(case)]
    convert = ["--ociofiletransform", lut, "-d", "float", "-o", tmp_path / "out.exr"]
    subprocess.run([oiiotool, luts.image, *convert], check=True)
    assert farthest(pixels_of(tmp_path / "out.exr"), luts, case) < TOLERANCE


@pytest.fixture(scope="module")
def config(luts, tmp_path_factory):
    written = tmp_path_factory.mktemp("config") / "config.ocio"
    with pytest.raises(SystemExit, match="0"):
        main.main(["ocio-config", *map(str, luts.files), "-o", str(written)])
    return written


def spaces_of(config):
    """Names of the color spaces of the config's LUTs, in the order of CASES."""
    read = ocio.Config.CreateFromFile(str(config))
    names = tuple(read.getColorSpaceFromFilepath(f"{'_'.join(case)}.tif")[0] for case in CASES)
    assert len(set(names)) == len(CASES)
    return names


@each_case
def test_oiiotool_gives_them_through_the_config_too(luts, config, oiiotool, case, tmp_path):
    space = spaces_of(config)[CASES.index(case)]
    convert = ["--colorconvert", space, "lin_rec709", "-d", "float", "-o", tmp_path / "out.exr"]
    subprocess.run([oiiotool, "--colorconfig", config, luts.image, *convert], check=True)
    assert farthest(pixels_of(tmp_path / "out.exr"), luts, case) < TOLERANCE


@pytest.fixture(scope="module")
def rendered(luts, config, tmp_path_factory):
    folder = tmp_path_factory.mktemp("rendered")
    python = blender_python()
    subprocess.run(
        [python, HERE / "blender_config_session.py", luts.image, folder, *spaces_of(config)],
        env={**os.environ, "OCIO": str(config), "BLENDER_USER_RESOURCES": str(folder / "user")},
        check=True,
        timeout=300,
    )
    return folder


@each_case
def test_blender_gives_them_through_the_config(luts, config, rendered, case):
    pixels = pixels_of(rendered / f"{spaces_of(config)[CASES.index(case)]}.exr")
    assert farthest(pixels, luts, case) < TOLERANCE


def pixels_of(path):
    return np.ascontiguousarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[..., :3])
