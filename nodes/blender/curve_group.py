"""A node group that holds a curve as native RGB curves.

It is saved in the .blend and renders where this extension is not installed. (A node type of this
extension's own would not: without the extension Blender makes it undefined.)

Blender samples an RGB curve at 257 places of its clipping region and goes straight between them,
which misses a real camera's curve by up to 9e-3. So a curve is cut into as few pieces as keep that
below `CLOSE`, one to six nodes as a rule. Each piece rises from 0 and is constant outside of its
part; their sum is the curve.
"""

from __future__ import annotations

import bpy
import numpy as np

from .command import Calibration

CLOSE = 1e-5
SAMPLES = 257
LENGTHS = (4096, 2048, 1024, 768, 512, 384)  # intervals to try; of 256 none is missed
PHOTO, VERDICT, REASON = "facecrf_photo", "facecrf_verdict", "facecrf_reason"


def new_curve_group(name: str, calibration: Calibration) -> bpy.types.NodeTree:
    """Return a new compositor group, image in and scene-linear image out."""
    tree = bpy.data.node_groups.new(f"Linearize {name}", "CompositorNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket(name="Image", in_out=way, socket_type="NodeSocketColor")
    fill(tree, name, calibration)
    return tree


def fill(tree: bpy.types.NodeTree, name: str, calibration: Calibration) -> None:
    """Put a curve into a group in place of what is there, with its photo's name and the verdict."""
    tree.nodes.clear()
    entry, leave = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    rows, total = np.array(calibration.rows), None
    for index, (first, last) in enumerate(_pieces(rows)):
        curves = tree.nodes.new("CompositorNodeCurveRGB")
        curves.location = (300, -400 * index)
        _fill_piece(curves.mapping, rows, first, last)
        tree.links.new(entry.outputs["Image"], curves.inputs["Image"])
        piece = curves.outputs["Image"]
        total = piece if total is None else _sum(tree, total, piece, index)
    tree.links.new(total, leave.inputs["Image"])
    leave.location = (800 + 200 * index, 0)
    tree.name = f"Linearize {name}"
    tree[PHOTO], tree[VERDICT], tree[REASON] = name, calibration.verdict, calibration.reason


def _sum(tree, total, piece, index):
    add = tree.nodes.new("ShaderNodeMix")
    add.location = (500 + 200 * index, 0)
    add.data_type, add.blend_type = "RGBA", "ADD"
    factor, first, second = (
        next(socket for socket in add.inputs if socket.identifier == name)
        for name in ("Factor_Float", "A_Color", "B_Color")
    )
    factor.default_value = 1.0
    tree.links.new(total, first)
    tree.links.new(piece, second)
    return next(socket for socket in add.outputs if socket.identifier == "Result_Color")


def _pieces(rows):
    # Where white is no end of a piece, the last reaches beyond it, so that samples meet entries.
    first, end = 0, len(rows) - 1
    while first < end:
        lasts = (end, *(first + length for length in LENGTHS))
        last = next((last for last in lasts if _miss(rows, first, last) < CLOSE), first + 256)
        yield first, last
        first = last


def _sampled(rows, first, last):
    places = np.linspace(first, last, SAMPLES)
    return places, [np.interp(places, np.arange(len(rows)), channel) for channel in rows.T]


def _miss(rows, first, last):
    entries = np.arange(first, min(last + 1, len(rows)))
    places, curves = _sampled(rows, first, last)
    drawn = np.stack([np.interp(entries, places, curve) for curve in curves], axis=-1)
    return np.abs(drawn - rows[entries]).max()


def _fill_piece(mapping, rows, first, last):
    places, curves = _sampled(rows, first, last)
    codes = places / (len(rows) - 1)
    mapping.use_clip = False
    mapping.extend = "HORIZONTAL"  # as OCIO does outside of a LUT's domain
    # Though nothing is clipped: the samples are spread over the clipping region.
    mapping.clip_max_x, mapping.clip_min_x = codes[-1], codes[0]
    for channel, curve in enumerate(curves):
        points = mapping.curves[channel].points
        linear = curve - curve[0] if first else curve
        points[0].location, points[-1].location = (codes[0], linear[0]), (codes[-1], linear[-1])
        for place in zip(codes[1:-1], linear[1:-1], strict=True):
            points.new(*place)
        for point in points:
            point.handle_type = "VECTOR"
    mapping.update()
