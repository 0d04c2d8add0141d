"""Run by Blender's own Python, with OCIO set to a config: the extension and the config, together.

`blender_extension_config_session.py ZIP COMMAND FOLDER IMAGE SPACE`: renders the image through the
space of the config and through the extension's node into FOLDER, and says what it saw in said.json.
"""

import json
import sys
from pathlib import Path

import bpy

package, command, folder, image_path, space = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.extensions.package_install_files(
    filepath=package, repo="user_default", enable_on_install=True
)
chosen = bpy.context.preferences.addons["bl_ext.user_default.facecrf_linearize"].preferences
chosen.command, chosen.estimator = command, "srgb"
image = bpy.data.images.load(image_path)
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y = image.size
scene.render.resolution_percentage = 100
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"


def render(name):
    scene.render.filepath = str(Path(folder, name))
    bpy.ops.render.render(write_still=True)


bpy.ops.facecrf.linearize_photo(image=image.name)
render("extension.exr")
bpy.ops.facecrf.linearize_image(image=image.name)
made = bpy.data.images[f"{image.name} (linear)"]
tree = scene.compositing_node_group
source = next(node for node in tree.nodes if node.bl_idname == "CompositorNodeImage")
leave = next(node for node in tree.nodes if node.bl_idname == "NodeGroupOutput")
image.colorspace_settings.name = space
source.image = image
for link in list(leave.inputs[0].links):
    tree.links.remove(link)
tree.links.new(source.outputs["Image"], leave.inputs[0])
render("space.exr")
said = {"made": list(made.pixels[:3]), "made_space": made.colorspace_settings.name}
Path(folder, "said.json").write_text(json.dumps(said))
