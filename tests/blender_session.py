"""Run by Blender's own Python: register the extension, use it, and print what happened as JSON."""

import json
import sys
from pathlib import Path

import bpy  # isort: skip
import addon_utils  # isort: skip  (bpy brings it)

photo, command, work = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
said = {}


def refused(operator, **options):
    try:
        operator(**options)
    except RuntimeError as error:
        return str(error)
    return ""


def render(path):
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = bpy.data.images[photo.name].size
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


bpy.ops.wm.read_factory_settings(use_empty=True)
addon_utils.enable("facecrf_linearize", default_set=True)
chosen = bpy.context.preferences.addons["facecrf_linearize"].preferences
chosen.estimator = "srgb"
bpy.data.images.load(str(photo))

chosen.command = "/nowhere/facecrf"
said["missing"] = refused(bpy.ops.facecrf.linearize_photo, image=photo.name)
chosen.command = command
bpy.ops.facecrf.linearize_photo(image=photo.name)
render(work / "before.exr")
bpy.ops.wm.save_as_mainfile(filepath=str(work / "saved.blend"))

said["folder"] = list(
    bpy.ops.facecrf.linearize_folder(directory=str(photo.parent), output=str(work / "exr"))
)
addon_utils.disable("facecrf_linearize", default_set=True)
said["left"] = [name for name in dir(bpy.types) if name.startswith("FACECRF_")]
bpy.ops.wm.open_mainfile(filepath=str(work / "saved.blend"))
render(work / "after.exr")
(work / "said.json").write_text(json.dumps(said))
