"""Where a photo's nodes go: the scene's compositor tree, or a material's or world's shader tree."""

from __future__ import annotations

import bpy

from .color_space import codes_of
from .command import CommandError
from .curve_group import COMPOSITOR, SHADER, VERDICT, new_curve_group
from .layout import frame, free_height

_IMAGE_NODES = {
    COMPOSITOR: ("CompositorNodeImage",),
    SHADER: ("ShaderNodeTexImage", "ShaderNodeTexEnvironment"),
}
_GROUP_NODES = {COMPOSITOR: "CompositorNodeGroup", SHADER: "ShaderNodeGroup"}
GROUPS = bpy.app.version >= (5, 0, 0)
"""Whether a scene's compositor is a node group, as from Blender 5.0 on."""


def tree_of(context, kind: str):
    """Return the tree of a kind that is being edited, or else the scene's or active object's."""
    space = context.space_data
    edited = getattr(space, "edit_tree", None)  # None but in node editors
    if edited is not None and edited.bl_idname == kind:
        return edited
    return _compositor(context.scene) if kind == COMPOSITOR else _material(context)


def _compositor(scene):
    if not GROUPS:
        made = scene.node_tree is None
        scene.use_nodes = True
        if made:
            scene.node_tree.links.clear()  # as a new tree is from 5.0 on, without a picture yet
        return scene.node_tree
    if scene.compositing_node_group is None:
        tree = bpy.data.node_groups.new("Compositing", COMPOSITOR)
        tree.interface.new_socket(name="Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        scene.compositing_node_group = tree
    return scene.compositing_node_group


def _material(context):
    chosen = context.object
    material = None if chosen is None else chosen.active_material
    if material is None:
        raise CommandError("choose an object with a material first")
    if not material.use_nodes:
        material.use_nodes = True
    return material.node_tree


def add_nodes(tree, image, calibration):
    """Add an image node and a Linearize Photo node, in a frame below what is there; return it."""
    kind = tree.bl_idname
    top = free_height(tree)
    source = tree.nodes.new(_IMAGE_NODES[kind][0])
    source.image = codes_of(image)
    node = tree.nodes.new(_GROUP_NODES[kind])
    node.node_tree = new_curve_group(image.name, calibration, kind)
    node.label = "Linearize Photo"
    source.location, node.location = (0, top), (300, top)
    tree.links.new(source.outputs[0], node.inputs["Image"])
    if kind == COMPOSITOR:
        _link_output(tree, node, top)
    frame(tree, image.name, (source, node))
    return node


def _link_output(tree, node, top):
    name = "NodeGroupOutput" if GROUPS else "CompositorNodeComposite"
    leave = next((n for n in tree.nodes if n.bl_idname == name), None)
    if leave is None:
        leave = tree.nodes.new(name)
        leave.location = (600, top)
    if leave.inputs and not leave.inputs[0].is_linked:
        tree.links.new(node.outputs["Image"], leave.inputs[0])


def is_ours(node) -> bool:
    """Whether a node is a Linearize Photo node."""
    return getattr(node, "node_tree", None) is not None and VERDICT in node.node_tree


def linked_image_node(tree, name: str):
    """Return a Linearize Photo node and the image node that feeds it; CommandError if amiss."""
    node = tree.nodes.get(name) if tree else None
    if not is_ours(node):
        raise CommandError(f"{name!r} is not a Linearize Photo node")
    for link in node.inputs[0].links:
        source = link.from_node
        if source.bl_idname in _IMAGE_NODES[tree.bl_idname] and source.image:
            return node, source
    raise CommandError("link an image node to the Linearize Photo node first")
