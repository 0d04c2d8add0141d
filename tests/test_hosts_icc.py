"""ICC profiles in darktable, RawTherapee and GIMP, where they are installed."""

from __future__ import annotations

import shutil
import subprocess

import matplotlib.cbook
import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from host_luts import estimated_curve
from PIL import Image

from facecrf_ocio.lut.write import write_lut

pytestmark = pytest.mark.slow

NEUTRAL = """[Version]
AppVersion=5.9
Version=349

[Exposure]
Auto=false

[Color Management]
InputProfile=file:{profile}
ToneCurve=false
ApplyLookTable=false
OutputProfile=RTv2_sRGB
OutputProfileIntent=Relative
WorkingProfile=sRGB
"""
# 1 is "without asking", 600 is 32-bit linear floating point.
GIMP_SCRIPT = """(let* ((image (car (gimp-file-load 1 "{photo}" "{photo}"))))
 (gimp-image-convert-precision image 600)
 (file-exr-save 1 image (car (gimp-image-get-active-drawable image)) "{exr}" "{exr}")
 (gimp-quit 0))"""


@pytest.fixture(scope="module")
def photo(tmp_path_factory):
    """A folder with tagged.png and tagged.tif, photo.icc, and the pixels to be expected."""
    folder = tmp_path_factory.mktemp("icc")
    curve = estimated_curve()
    profile = write_lut(curve, folder / "photo.icc")
    portrait = matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)
    small = Image.open(portrait).convert("RGB").resize((256, 300))
    for name in ("tagged.png", "tagged.tif"):
        small.save(folder / name, icc_profile=profile.read_bytes())
    return folder, curve.linearize(np.asarray(small) / 255.0)


def run(program, *arguments, home):
    found = shutil.which(program)
    if found is None:
        pytest.skip(f"{program} is not installed")
    subprocess.run(
        [found, *map(str, arguments)],
        check=True,
        capture_output=True,
        timeout=180,
        env={"HOME": str(home), "PATH": "/usr/bin:/bin"},
    )


def pixels(path):
    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[..., :3].astype(np.float64)


def test_darktable(photo, tmp_path):
    folder, expected = photo
    export = ["--icc-type", "LIN_REC709", "--apply-custom-presets", "0"]
    core = ["--core", "--configdir", tmp_path, "--conf", "plugins/darkroom/workflow=none"]
    run("darktable-cli", folder / "tagged.png", tmp_path / "a.exr", *export, *core, home=tmp_path)
    assert np.abs(pixels(tmp_path / "a.exr") - expected).max() < 2e-4


def test_gimp(photo, tmp_path):
    folder, expected = photo
    script = GIMP_SCRIPT.format(photo=folder / "tagged.tif", exr=tmp_path / "a.exr")
    run("gimp-console", "-i", "-b", script.replace("\n", ""), home=tmp_path)
    assert np.abs(pixels(tmp_path / "a.exr") - expected).max() < 2e-4


def test_rawtherapee(photo, tmp_path):
    folder, expected = photo
    neutral, out = tmp_path / "neutral.pp3", tmp_path / "a.tif"
    neutral.write_text(NEUTRAL.format(profile=folder / "photo.icc"))
    output = ["-o", out, "-b32", "-t", "-Y", "-a", "-p", neutral, "-c", folder / "tagged.tif"]
    run("rawtherapee-cli", *output, home=tmp_path)
    codes = pixels(out)
    linear = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    assert np.abs(linear - expected).max() < 2e-3
