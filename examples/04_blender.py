"""
Blender without a window
========================

A photo linearized by the extension's own nodes and rendered.

Blender has an environment of its own: `python3.11 -m venv ENV; ENV/bin/pip install bpy==5.0.1`,
then set BLENDER_PYTHON=ENV/bin/python (or put it where the tests keep theirs).
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.cbook
import numpy as np
import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio import calibrate, read_photo

IN_BLENDER = """
import sys, bpy, addon_utils
photo, command, exr = sys.argv[1:]
addon_utils.enable("facecrf_linearize", default_set=True)
bpy.context.preferences.addons["facecrf_linearize"].preferences.command = command
image = bpy.data.images.load(photo)
bpy.ops.facecrf.linearize_photo(image=image.name)
render = bpy.context.scene.render
render.resolution_x, render.resolution_y = image.size
render.resolution_percentage = 100
render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
render.filepath = exr
bpy.ops.render.render(write_still=True)
"""

extension = Path(__file__).parents[1] / "nodes" / "blender"
tests_own = Path.home() / ".cache" / "facecrf-tests" / "bpy-5.0.1" / "bin" / "python"
blender = Path(os.environ.get("BLENDER_PYTHON", tests_own))
command = Path(sys.executable).parent / "facecrf"
if not blender.is_file() or not command.is_file():
    missing = blender if not blender.is_file() else command
    print(f"skipped: no {missing}; see the top of {Path(__file__).name}")
    sys.exit()

with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    shutil.copytree(extension, folder / "modules" / "facecrf_linearize")
    # A PNG, since Blender and OpenImageIO do not decode each JPEG to the same codes.
    photo, exr = folder / "grace_hopper.png", folder / "linear.exr"
    portrait = matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)
    oiio.ImageBuf(str(portrait)).write(str(photo))
    session = {"PYTHONPATH": str(folder / "modules"), "BLENDER_USER_RESOURCES": name}
    subprocess.run(
        [blender, "-c", IN_BLENDER, photo, command, exr],
        env={**os.environ, **session},
        check=True,
        stdout=subprocess.DEVNULL,
    )
    read = read_photo(photo)
    expected = calibrate(read).curve.linearize(read.encoded)
    difference = np.abs(oiio.ImageBuf(str(exr)).get_pixels(oiio.FLOAT)[..., :3] - expected).max()
print(f"Blender and this package differ by {difference:.1e} at most")
assert difference < 2e-5
