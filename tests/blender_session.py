"""Run by Blender's own Python: install the extension's zip, use it, and write what happened.

`blender_session.py ZIP COMMAND WORK PORTRAIT RAMP ESTIMATOR...`: images and said.json into WORK.
"""

import json
import sys
from pathlib import Path

import bpy

package, command, portrait, ramp = sys.argv[1], sys.argv[2], Path(sys.argv[4]), Path(sys.argv[5])
work, estimators = Path(sys.argv[3]), sys.argv[6:]
said = {}


def refused(operator, **options):
    try:
        operator(**options)
    except RuntimeError as error:
        return str(error)
    return ""


def render(image, path):
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = image.size
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def only(kind):
    nodes = bpy.context.scene.compositing_node_group.nodes
    return next(node for node in nodes if node.bl_idname == kind)


bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.extensions.package_install_files(
    filepath=package, repo="user_default", enable_on_install=True
)
name = "bl_ext.user_default.facecrf_linearize"
chosen = bpy.context.preferences.addons[name].preferences
said["panel"] = bpy.types.FACECRF_PT_panel.bl_label
said["menu"] = [
    f.__module__ for f in bpy.types.NODE_MT_compositor_node_add_all._dyn_ui_initialize()
]
photo, codes = (bpy.data.images.load(str(path)) for path in (portrait, ramp))

chosen.command = "/nowhere/facecrf"
said["missing"] = refused(bpy.ops.facecrf.linearize_photo, image=photo.name)
said["missing_for_folder"] = refused(
    bpy.ops.facecrf.linearize_folder, directory=str(portrait.parent), output=str(work / "none")
)
chosen.command = command
chosen.estimator = estimators[0]
said["unloaded"] = refused(bpy.ops.facecrf.linearize_photo, image="other.png")
bpy.ops.facecrf.linearize_photo(image=photo.name)
node, source = only("CompositorNodeGroup"), only("CompositorNodeImage")
said["node"] = node.label
for estimator in estimators:
    source.image = photo
    chosen.estimator = estimator
    bpy.ops.facecrf.calibrate_node(node=node.name)
    render(photo, work / f"portrait_{estimator}.exr")
    codes.colorspace_settings.name = "Non-Color"
    source.image = codes
    render(codes, work / f"ramp_{estimator}.exr")
said["unlinked"] = refused(bpy.ops.facecrf.calibrate_node, node=source.name)
bpy.ops.wm.save_as_mainfile(filepath=str(work / "saved.blend"))

chosen.estimator = "srgb"
said["folder"] = list(
    bpy.ops.facecrf.linearize_folder(directory=str(portrait.parent), output=str(work / "exr"))
)
bpy.ops.preferences.addon_disable(module=name)
said["left"] = [name for name in dir(bpy.types) if name.startswith("FACECRF_")]
bpy.ops.wm.open_mainfile(filepath=str(work / "saved.blend"))
render(bpy.data.images[ramp.name], work / f"reloaded_{estimators[-1]}.exr")
(work / "said.json").write_text(json.dumps(said))
