"""Where new nodes stand, the frame that names their photo, and the view that shows them."""

from __future__ import annotations

import bpy

_APART = 80  # between the nodes of two photos, in the units of node locations
_HIGHEST = 300  # of a node that was not drawn yet and has no height
_DRAWN = 0.1  # [s] until new nodes have been drawn, and have a size


def free_height(tree) -> float:
    """Return the height below every node of a tree."""
    lowest = [
        _top(node) - max(node.dimensions.y, node.height, _HIGHEST)
        for node in tree.nodes
        if node.bl_idname != "NodeFrame"
    ]
    return min(lowest) - _APART if lowest else 0


def frame(tree, name: str, nodes) -> None:
    """Put nodes into a frame that says whose they are, and choose them alone."""
    around = tree.nodes.new("NodeFrame")
    around.label = name
    for node in nodes:
        node.parent = around
    for other in tree.nodes:
        other.select = other in nodes
    tree.nodes.active = nodes[-1]


def rename(node, old: str, new: str) -> None:
    """Call a node's frame after its new photo, unless someone gave it a name."""
    if node.parent is not None and node.parent.label == old:
        node.parent.label = new


def show(context, tree) -> None:
    """Center the chosen nodes in every editor that shows their tree, once they are drawn."""
    if not bpy.app.background and context.window_manager.windows:
        bpy.app.timers.register(lambda: _center(tree.name), first_interval=_DRAWN)


def _center(name: str) -> None:
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            edited = getattr(area.spaces.active, "edit_tree", None)
            if area.type == "NODE_EDITOR" and edited is not None and edited.name == name:
                region = next(region for region in area.regions if region.type == "WINDOW")
                with bpy.context.temp_override(window=window, area=area, region=region):
                    bpy.ops.node.view_selected()


def _top(node) -> float:
    """Height of a node's upper edge in the tree; within a frame locations are the frame's."""
    height = node.location.y
    while node.parent is not None:
        node = node.parent
        height += node.location.y
    return height
