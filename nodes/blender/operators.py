"""What the menus and panels do."""

# Names, signatures and lists as Blender asks for them.
# ruff: noqa: D102, D400, N801, ARG002, RUF012

from __future__ import annotations

from pathlib import Path

import bpy

from .color_space import CODES_OF, SPACE, codes_of, linear_image
from .command import CommandError, calibrate, find_command, linearize
from .curve_group import COMPOSITOR, PHOTO, SHADER, fill
from .layout import rename, show
from .photo_file import photo_file
from .preferences import preferences
from .trees import add_nodes, linked_image_node, tree_of
from .working import Working

PHOTOS = {".jpg", ".jpeg", ".png", ".tif", ".tiff"}


class _OneImage(Working):
    image: bpy.props.StringProperty(name="Image")

    def invoke(self, context, event):
        self._modal = True
        if self.image:
            return self.begin(context)
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, context):
        self.layout.prop_search(self, "image", bpy.data, "images")

    def calibrated(self, context, image):
        """Yield the command; return the curve."""
        chosen = preferences(context)
        self.say(f"Calibrating {image.name}")
        with photo_file(image) as path:
            return (yield from calibrate(chosen.path, path, chosen.estimator, SPACE))

    def tell(self, image, found):
        """Report what the curve is good for."""
        self.report({"INFO"}, f"{image.name}: {found.verdict}: {found.reason}")


class FACECRF_OT_linearize_photo(_OneImage, bpy.types.Operator):
    """Calibrate an image by the faces in it and add a copy of it, with its curve, to the nodes"""

    bl_idname = "facecrf.linearize_photo"
    bl_label = "Linearize Photo"
    bl_options = {"REGISTER", "UNDO"}

    tree: bpy.props.EnumProperty(
        name="Nodes",
        items=((COMPOSITOR, "Compositor", ""), (SHADER, "Material", "")),
        default=COMPOSITOR,
    )

    def work(self, context):
        image = _loaded(self.image)
        tree = tree_of(context, self.tree)
        found = yield from self.calibrated(context, image)
        add_nodes(tree, image, found)
        show(context, tree)
        self.tell(image, found)


class FACECRF_OT_calibrate_node(_OneImage, bpy.types.Operator):
    """Calibrate the image that is linked to this Linearize Photo node, and replace its curve"""

    bl_idname = "facecrf.calibrate_node"
    bl_label = "Calibrate Linked Image"
    bl_options = {"REGISTER", "UNDO"}

    node: bpy.props.StringProperty(name="Node")
    tree: bpy.props.StringProperty(default=COMPOSITOR)

    def invoke(self, context, event):
        self._modal = True
        return self.begin(context)

    def work(self, context):
        node, source = linked_image_node(tree_of(context, self.tree), self.node)
        image = source.image
        found = yield from self.calibrated(context, image)
        source.image = codes_of(image)
        name = image.get(CODES_OF, image.name)
        rename(node, node.node_tree[PHOTO], name)
        fill(node.node_tree, name, found)
        self.tell(image, found)


class FACECRF_OT_linearize_image(_OneImage, bpy.types.Operator):
    """Calibrate an image and make a new image of it in scene-linear light; the image stays"""

    bl_idname = "facecrf.linearize_image"
    bl_label = "Linearize into a New Image"
    bl_options = {"REGISTER", "UNDO"}

    def work(self, context):
        image = _loaded(self.image)
        found = yield from self.calibrated(context, image)
        made = linear_image(image, found)
        space = context.space_data
        if space is not None and space.type == "IMAGE_EDITOR":
            space.image = made
        self.tell(image, found)


class FACECRF_OT_linearize_folder(Working, bpy.types.Operator):
    """Write every photo of a folder as a scene-linear EXR into another folder"""

    bl_idname = "facecrf.linearize_folder"
    bl_label = "Linearize Folder"

    directory: bpy.props.StringProperty(name="Photos", subtype="DIR_PATH")
    output: bpy.props.StringProperty(name="EXR files", subtype="DIR_PATH")

    def invoke(self, context, event):
        self._modal = True
        return context.window_manager.invoke_props_dialog(self)

    def work(self, context):
        chosen = preferences(context)
        source, target = (Path(bpy.path.abspath(p)) for p in (self.directory, self.output))
        if not self.directory or not self.output or not source.is_dir():
            raise CommandError("name a folder of photos and a folder for the EXR files")
        find_command(chosen.path)
        try:
            target.mkdir(parents=True, exist_ok=True)
            photos = sorted(p for p in source.iterdir() if p.suffix.lower() in PHOTOS)
        except OSError as error:
            raise CommandError(str(error)) from None
        written = 0
        for number, photo in enumerate(photos):
            self.say(
                f"Linearizing {photo.name}, {number + 1} of {len(photos)}", number / len(photos)
            )
            try:
                exr = target / f"{photo.name}.exr"
                yield from linearize(chosen.path, photo, exr, chosen.estimator)
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
