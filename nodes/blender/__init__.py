"""Linearize Photo: a photo's curve, estimated by `facecrf`, as nodes that Blender has itself."""

# Copyright 2025-2026 The facecrf-ocio developers
# SPDX-License-Identifier: GPL-3.0-or-later
# Names, signatures and lists as Blender asks for them.
# ruff: noqa: D101, D102, D103, N801

from __future__ import annotations

import textwrap

import bpy

from .color_space import CODES_OF
from .curve_group import COMPOSITOR, REASON, SHADER, VERDICT
from .operators import (
    FACECRF_OT_calibrate_node,
    FACECRF_OT_linearize_folder,
    FACECRF_OT_linearize_image,
    FACECRF_OT_linearize_photo,
)
from .preferences import FacecrfPreferences
from .trees import is_ours

_READ = ("FILE", "GENERATED")
_LINE_LENGTH = 40  # characters, which the sidebar holds as wide as it opens
_LINE_HEIGHT = 0.75  # of a button's: lines of one text stand together
_MENUS = {
    "NODE_MT_compositor_node_add_all": COMPOSITOR,
    "NODE_MT_shader_node_add_all": SHADER,
}


class FACECRF_PT_panel(bpy.types.Panel):
    bl_label = "Linearize Photo"
    bl_space_type = "NODE_EDITOR"
    bl_region_type = "UI"
    bl_category = "facecrf"

    @classmethod
    def poll(cls, context):
        return context.space_data.tree_type in (COMPOSITOR, SHADER)

    def draw(self, context):
        self.layout.operator_context = "INVOKE_DEFAULT"
        kind = context.space_data.tree_type
        images = [i for i in bpy.data.images if i.source in _READ and CODES_OF not in i]
        told = "Add an image, linearized:" if images else "Open a photo in the Image Editor first."
        self.layout.label(text=told)
        for image in images:
            row = self.layout.operator("facecrf.linearize_photo", text=image.name)
            row.image, row.tree = image.name, kind
        self.layout.operator("facecrf.linearize_folder")
        node = context.active_node
        if is_ours(node):
            box = self.layout.box()
            said = box.column(align=True)
            said.scale_y = _LINE_HEIGHT
            said.label(text=f"{node.node_tree[VERDICT]} curve")
            for line in textwrap.wrap(node.node_tree[REASON], _LINE_LENGTH):
                said.label(text=line)
            row = box.operator("facecrf.calibrate_node")
            row.node, row.tree = node.name, kind


class FACECRF_PT_image(bpy.types.Panel):
    bl_label = "Linearize Photo"
    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "facecrf"

    @classmethod
    def poll(cls, context):
        return context.space_data.image is not None

    def draw(self, context):
        self.layout.operator_context = "INVOKE_DEFAULT"
        row = self.layout.operator("facecrf.linearize_image")
        row.image = context.space_data.image.name
        self.layout.label(text="The image itself stays as it is.")


def _add_to(kind):
    def menu(self, context):
        # Menus of both kinds of tree are drawn from one list in some versions.
        if context.space_data is not None and context.space_data.tree_type == kind:
            self.layout.operator_context = "INVOKE_DEFAULT"
            self.layout.operator("facecrf.linearize_photo").tree = kind

    return menu


CLASSES = (
    FacecrfPreferences,
    FACECRF_OT_linearize_photo,
    FACECRF_OT_calibrate_node,
    FACECRF_OT_linearize_image,
    FACECRF_OT_linearize_folder,
    FACECRF_PT_panel,
    FACECRF_PT_image,
)
_added = []


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    for name, kind in _MENUS.items():
        menu, entry = getattr(bpy.types, name), _add_to(kind)
        menu.append(entry)
        _added.append((menu, entry))


def unregister():
    while _added:
        menu, entry = _added.pop()
        menu.remove(entry)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
