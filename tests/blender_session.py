"""Run by Blender's own Python: install the extension's zip, use it, and write what happened.

`blender_session.py ZIP COMMAND WORK PORTRAIT RAMP ESTIMATOR...`: images and said.json into WORK.
"""

import json
import sys
from pathlib import Path

import bpy

package, command, portrait, ramp = sys.argv[1], sys.argv[2], Path(sys.argv[4]), Path(sys.argv[5])
work, estimators = Path(sys.argv[3]), sys.argv[6:]
said = {"version": bpy.app.version_string}
NEW = bpy.app.version >= (5, 0, 0)


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


def tree():
    return bpy.context.scene.compositing_node_group if NEW else bpy.context.scene.node_tree


def only(kind):
    return next(node for node in tree().nodes if node.bl_idname == kind)


def boxes(nodes):
    return [(*node.location, node.width, 300) for node in nodes if "Group" not in node.bl_idname]


bpy.ops.wm.read_factory_settings(use_empty=True)
if not NEW:
    bpy.context.scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(bpy.context.scene.camera)
bpy.ops.extensions.package_install_files(
    filepath=package, repo="user_default", enable_on_install=True
)
name = "bl_ext.user_default.facecrf_linearize"
chosen = bpy.context.preferences.addons[name].preferences
said["panel"] = bpy.types.FACECRF_PT_panel.bl_label
said["menu"] = [
    f.__module__ for f in bpy.types.NODE_MT_compositor_node_add_all._dyn_ui_initialize()
]
said["estimators"] = [item.identifier for item in chosen.bl_rna.properties["estimator"].enum_items]
photo, codes = (bpy.data.images.load(str(path)) for path in (portrait, ramp))
before = photo.colorspace_settings.name

chosen.command = "/nowhere/facecrf"
said["missing"] = refused(bpy.ops.facecrf.linearize_photo, image=photo.name)
said["missing_for_folder"] = refused(
    bpy.ops.facecrf.linearize_folder, directory=str(portrait.parent), output=str(work / "none")
)
chosen.command = command
chosen.estimator = estimators[0]
said["unloaded"] = refused(bpy.ops.facecrf.linearize_photo, image="other.png")
said["no_material"] = refused(
    bpy.ops.facecrf.linearize_photo, image=photo.name, tree="ShaderNodeTree"
)
bpy.ops.facecrf.linearize_photo(image=photo.name)
node, source = only("CompositorNodeGroup"), only("CompositorNodeImage")
said["node"] = node.label
said["kept_space"] = photo.colorspace_settings.name == before
said["copy_is_data"] = source.image.colorspace_settings.is_data and source.image != photo
for estimator in estimators:
    source.image = photo
    chosen.estimator = estimator
    bpy.ops.facecrf.calibrate_node(node=node.name)
    render(photo, work / f"portrait_{estimator}.exr")
    codes.colorspace_settings.is_data = True
    source.image = codes
    render(codes, work / f"ramp_{estimator}.exr")
said["unlinked"] = refused(bpy.ops.facecrf.calibrate_node, node=source.name)
bpy.ops.wm.save_as_mainfile(filepath=str(work / "saved.blend"))

chosen.estimator = "srgb"
# A second photo, a packed one, and one painted in Blender.
bpy.ops.facecrf.linearize_photo(image=photo.name)
framed = [node for node in tree().nodes if node.bl_idname == "CompositorNodeImage"]
said["places"] = [node.location.y + node.parent.location.y for node in framed]
said["frames"] = [[n.parent.label, n.bl_idname] for n in tree().nodes if n.parent is not None]
packed = bpy.data.images.load(str(portrait), check_existing=False)
packed.name = "packed"
packed.pack()
packed.filepath = "//gone.png"
said["packed"] = refused(bpy.ops.facecrf.linearize_photo, image=packed.name)
painted = bpy.data.images.new("painted", 64, 32)
painted.pixels.foreach_set([0.5, 0.25, 0.75, 1.0] * (64 * 32))
painted.update()
bpy.ops.facecrf.linearize_image(image=painted.name)
made = bpy.data.images["painted (linear)"]
said["painted"] = list(made.pixels[:3])
said["painted_codes"] = list(painted.pixels[:3])
said["made_space"] = made.colorspace_settings.name
# A photo that was painted on, and not saved.
repainted = bpy.data.images.load(str(portrait), check_existing=False)
repainted.pixels[:4] = (0.25, 0.5, 0.75, 1.0)
repainted.update()
bpy.ops.facecrf.linearize_photo(image=repainted.name)
said["repainted"] = list(bpy.data.images[f"{repainted.name} (codes)"].pixels[:3])
said["still_dirty"] = repainted.is_dirty

# The same in a material, rendered by Cycles as light that a camera sees.
chosen.estimator = estimators[-1]
bpy.ops.mesh.primitive_plane_add(size=2)
plane = bpy.context.object
material = bpy.data.materials.new("Photo")
material.use_nodes = True
plane.data.materials.append(material)
bpy.ops.facecrf.linearize_photo(image=photo.name, tree="ShaderNodeTree")
shader = material.node_tree
group = next(n for n in shader.nodes if n.bl_idname == "ShaderNodeGroup")
texture = next(n for n in shader.nodes if n.bl_idname == "ShaderNodeTexImage")
texture.image, texture.interpolation = codes, "Closest"
emission = shader.nodes.new("ShaderNodeEmission")
output = next(n for n in shader.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
shader.links.new(group.outputs[0], emission.inputs["Color"])
shader.links.new(emission.outputs[0], output.inputs["Surface"])
scene = bpy.context.scene
camera = scene.camera or bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
if scene.camera is None:
    scene.collection.objects.link(camera)
    scene.camera = camera
camera.location, camera.data.type, camera.data.ortho_scale = (0, 0, 1), "ORTHO", 2
scene.render.engine, scene.cycles.samples, scene.cycles.device = "CYCLES", 1, "CPU"
scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
scene.render.use_compositing = False
render(codes, work / "material.exr")
scene.render.use_compositing = True

chosen.estimator = "srgb"
said["folder"] = list(
    bpy.ops.facecrf.linearize_folder(directory=str(portrait.parent), output=str(work / "exr"))
)
bpy.ops.preferences.addon_disable(module=name)
said["left"] = [name for name in dir(bpy.types) if name.startswith("FACECRF_")]
bpy.ops.wm.open_mainfile(filepath=str(work / "saved.blend"))
render(bpy.data.images[ramp.name], work / f"reloaded_{estimators[-1]}.exr")
(work / "said.json").write_text(json.dumps(said))
