"""Linearize Photo: a photo's curve, estimated by `facecrf`, as native compositor nodes."""

# Names, signatures and lists as Blender asks for them.
# ruff: noqa: D101, D102, D103, D400, N801, ARG001, ARG002, RUF012

from __future__ import annotations

from pathlib import Path

import bpy

from .command import CommandError, calibrate, find_command, linearize
from .curve_group import VERDICT, fill, new_curve_group

PHOTOS = {".jpg", ".jpeg", ".png", ".tif", ".tiff"}


class FacecrfPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    command: bpy.props.StringProperty(
        name="facecrf command", default="facecrf", subtype="FILE_PATH"
    )
    estimator: bpy.props.StringProperty(name="Estimator", default="auto")

    def draw(self, context):
        self.layout.prop(self, "command")
        self.layout.prop(self, "estimator")
        try:
            find_command(self.command)
        except CommandError as error:
            self.layout.label(text=str(error), icon="ERROR")


def _preferences(context):
    return context.preferences.addons[__package__].preferences


class FACECRF_OT_linearize_photo(bpy.types.Operator):
    """Calibrate an image from the faces in it and add its curve to the compositor"""

    bl_idname = "facecrf.linearize_photo"
    bl_label = "Linearize Photo"
    bl_options = {"REGISTER", "UNDO"}

    image: bpy.props.StringProperty(name="Image")

    def invoke(self, context, event):
        if self.image:
            return self.execute(context)
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, context):
        self.layout.prop_search(self, "image", bpy.data, "images")

    def execute(self, context):
        try:
            image = _loaded(self.image)
            found = _calibrate(context, image)
        except CommandError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        _add_nodes(context.scene, image, new_curve_group(image.name, found))
        self.report({"INFO"}, f"{image.name}: {found.verdict}: {found.reason}")
        return {"FINISHED"}


class FACECRF_OT_calibrate_node(bpy.types.Operator):
    """Calibrate the image that is linked to this Linearize Photo node, and replace its curve"""

    bl_idname = "facecrf.calibrate_node"
    bl_label = "Calibrate Linked Image"
    bl_options = {"REGISTER", "UNDO"}

    node: bpy.props.StringProperty(name="Node")

    def execute(self, context):
        tree = context.scene.compositing_node_group
        node = tree.nodes.get(self.node) if tree else None
        try:
            if not _is_ours(node):
                raise CommandError(f"{self.node!r} is not a Linearize Photo node")
            linked = [link.from_node for link in node.inputs[0].links]
            if not linked or linked[0].bl_idname != "CompositorNodeImage" or not linked[0].image:
                raise CommandError("link an Image node to the Linearize Photo node first")
            image = linked[0].image
            found = _calibrate(context, image)
        except CommandError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        image.colorspace_settings.name = "Non-Color"
        fill(node.node_tree, image.name, found)
        self.report({"INFO"}, f"{image.name}: {found.verdict}: {found.reason}")
        return {"FINISHED"}


class FACECRF_OT_linearize_folder(bpy.types.Operator):
    """Write every photo of a folder as a scene-linear EXR into another folder"""

    bl_idname = "facecrf.linearize_folder"
    bl_label = "Linearize Folder"

    directory: bpy.props.StringProperty(name="Photos", subtype="DIR_PATH")
    output: bpy.props.StringProperty(name="EXR files", subtype="DIR_PATH")

    def invoke(self, context, event):
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        chosen = _preferences(context)
        source, target = (Path(bpy.path.abspath(p)) for p in (self.directory, self.output))
        if not self.directory or not self.output or not source.is_dir():
            self.report({"ERROR"}, "name a folder of photos and a folder for the EXR files")
            return {"CANCELLED"}
        try:
            find_command(chosen.command)
            target.mkdir(parents=True, exist_ok=True)
            photos = sorted(p for p in source.iterdir() if p.suffix.lower() in PHOTOS)
        except (CommandError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        written = 0
        for photo in photos:
            try:
                linearize(chosen.command, photo, target / f"{photo.name}.exr", chosen.estimator)
                written += 1
            except CommandError as error:
                self.report({"WARNING"}, str(error))
        self.report({"INFO"}, f"{written} of {len(photos)} photos written to {target}")
        return {"FINISHED"} if written else {"CANCELLED"}


def _loaded(name):
    image = bpy.data.images.get(name)
    if image is None:
        raise CommandError(f"no image is named {name!r}; load it first")
    return image


def _calibrate(context, image):
    path = Path(bpy.path.abspath(image.filepath, library=image.library))
    if not image.filepath or not path.is_file():
        raise CommandError(f"{image.name}: is not a file on disk; save the image first")
    chosen = _preferences(context)
    return calibrate(chosen.command, path, chosen.estimator)


def _is_ours(node):
    return getattr(node, "node_tree", None) is not None and VERDICT in node.node_tree


def _add_nodes(scene, image, group):
    # The curve expects code values, not what Blender would make of them.
    image.colorspace_settings.name = "Non-Color"
    tree = scene.compositing_node_group
    if tree is None:
        tree = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
        tree.interface.new_socket(name="Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        scene.compositing_node_group = tree
    source = tree.nodes.new("CompositorNodeImage")
    source.image = image
    node = tree.nodes.new("CompositorNodeGroup")
    node.node_tree = group
    node.label = "Linearize Photo"
    node.location = (250, 0)
    tree.links.new(source.outputs["Image"], node.inputs["Image"])
    leave = next((n for n in tree.nodes if n.bl_idname == "NodeGroupOutput"), None)
    if leave is None:
        leave = tree.nodes.new("NodeGroupOutput")
        leave.location = (500, 0)
    if leave.inputs and not leave.inputs[0].is_linked:
        tree.links.new(node.outputs["Image"], leave.inputs[0])


class FACECRF_PT_panel(bpy.types.Panel):
    bl_label = "Linearize Photo"
    bl_space_type = "NODE_EDITOR"
    bl_region_type = "UI"
    bl_category = "facecrf"

    @classmethod
    def poll(cls, context):
        return context.space_data.tree_type == "CompositorNodeTree"

    def draw(self, context):
        for image in bpy.data.images:
            if image.source == "FILE":
                row = self.layout.operator("facecrf.linearize_photo", text=image.name)
                row.image = image.name
        self.layout.operator("facecrf.linearize_folder")
        if _is_ours(context.active_node):
            box = self.layout.box()
            box.label(text=f"{context.active_node.node_tree[VERDICT]} curve")
            row = box.operator("facecrf.calibrate_node")
            row.node = context.active_node.name


def _add_menu(menu, context):
    menu.layout.operator_context = "INVOKE_DEFAULT"
    menu.layout.operator("facecrf.linearize_photo")


CLASSES = (
    FacecrfPreferences,
    FACECRF_OT_linearize_photo,
    FACECRF_OT_calibrate_node,
    FACECRF_OT_linearize_folder,
    FACECRF_PT_panel,
)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.NODE_MT_compositor_node_add_all.append(_add_menu)


def unregister():
    bpy.types.NODE_MT_compositor_node_add_all.remove(_add_menu)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
