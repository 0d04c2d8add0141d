"""A node group that holds a curve as native RGB curves.

It is saved in the .blend and renders where this extension is not installed.
"""

from __future__ import annotations

import bpy

from .command import Calibration

# Blender resamples curves at 1/256; points four times as dense leave that as the only error.
POINTS = 1025


def new_curve_group(name: str, calibration: Calibration) -> bpy.types.NodeTree:
    """Return a new compositor group, image in and scene-linear image out."""
    tree = bpy.data.node_groups.new(f"Linearize {name}", "CompositorNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket(name="Image", in_out=way, socket_type="NodeSocketColor")
    entry, leave = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    curves = tree.nodes.new("CompositorNodeCurveRGB")
    entry.location, leave.location = (-300, 0), (350, 0)
    tree.links.new(entry.outputs["Image"], curves.inputs["Image"])
    tree.links.new(curves.outputs["Image"], leave.inputs["Image"])
    _fill(curves.mapping, calibration)
    tree["facecrf_photo"] = name
    tree["facecrf_verdict"] = calibration.verdict
    tree["facecrf_reason"] = calibration.reason
    return tree


def _fill(mapping: bpy.types.CurveMapping, calibration: Calibration) -> None:
    mapping.use_clip = False
    mapping.extend = "HORIZONTAL"  # as OCIO does outside of a LUT's domain
    for channel in range(3):
        column = [row[channel] for row in calibration.rows]
        points = mapping.curves[channel].points
        points[0].location, points[-1].location = (0.0, column[0]), (1.0, column[-1])
        for index in range(1, POINTS - 1):
            code = index / (POINTS - 1)
            points.new(code, _between(column, code))
        for point in points:
            point.handle_type = "VECTOR"
    mapping.update()


def _between(column: list[float], code: float) -> float:
    position = code * (len(column) - 1)
    below = min(int(position), len(column) - 2)
    part = position - below
    return column[below] * (1.0 - part) + column[below + 1] * part
