"""Run by Blender's own Python, with OCIO set to a config: render an image in its color spaces.

`blender_config_session.py IMAGE FOLDER SPACE...` writes FOLDER/SPACE.exr.
"""

import sys
from pathlib import Path

import bpy

image_path, folder, spaces = sys.argv[1], Path(sys.argv[2]), sys.argv[3:]
bpy.ops.wm.read_factory_settings(use_empty=True)
image = bpy.data.images.load(image_path)
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y = image.size
scene.render.resolution_percentage = 100
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
tree = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
tree.interface.new_socket(name="Image", in_out="OUTPUT", socket_type="NodeSocketColor")
scene.compositing_node_group = tree
source, leave = tree.nodes.new("CompositorNodeImage"), tree.nodes.new("NodeGroupOutput")
source.image = image
tree.links.new(source.outputs["Image"], leave.inputs[0])
for space in spaces:
    image.colorspace_settings.name = space
    scene.render.filepath = str(folder / f"{space}.exr")
    bpy.ops.render.render(write_still=True)
