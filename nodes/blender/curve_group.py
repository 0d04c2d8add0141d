"""A node group, for the compositor or for shaders, that holds a curve as native RGB curves.

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

from .color_space import from_rec709
from .command import Calibration

CLOSE = 1e-5
SAMPLES = 257
LENGTHS = (4096, 2048, 1024, 768, 512, 384)  # intervals to try; of 256 none is missed
OLD_COMPOSITOR = bpy.app.version < (4, 5, 0)
"""Whether the compositor has mixing and math nodes of its own, and its curve of all channels, which
is asked last, ends at the width of the clipping region."""
PHOTO, VERDICT, REASON = "facecrf_photo", "facecrf_verdict", "facecrf_reason"


COMPOSITOR, SHADER = "CompositorNodeTree", "ShaderNodeTree"
# Of each kind of tree: the curve node, and the older mixing node where there is no common one.
_CURVES = {COMPOSITOR: "CompositorNodeCurveRGB", SHADER: "ShaderNodeRGBCurve"}
_PREFIX = {COMPOSITOR: "CompositorNode", SHADER: "ShaderNode"}


def new_curve_group(name: str, calibration: Calibration, kind: str) -> bpy.types.NodeTree:
    """Return a new group for trees of a kind, code values in and scene-linear light out."""
    tree = bpy.data.node_groups.new(f"Linearize {name}", kind)
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
        curves = tree.nodes.new(_CURVES[tree.bl_idname])
        curves.location = (300, -400 * index)
        _fill_piece(curves.mapping, rows, (first, last), shader=tree.bl_idname == SHADER)
        tree.links.new(entry.outputs["Image"], _colors(curves.inputs)[0])
        piece = curves.outputs[0]
        total = piece if total is None else _sum(tree, total, piece, index)
    right = 800 + 200 * index
    matrix = from_rec709() @ np.array(calibration.matrix)
    if not np.allclose(matrix, np.eye(3), atol=1e-6):
        total = _multiplied(tree, total, matrix.tolist(), right)
        right += 1000
    tree.links.new(total, leave.inputs["Image"])
    leave.location = (right, 0)
    tree.name = f"Linearize {name}"
    tree[PHOTO], tree[VERDICT], tree[REASON] = name, calibration.verdict, calibration.reason


def _colors(sockets):
    return [socket for socket in sockets if socket.type == "RGBA" and socket.enabled]


def _shared_node(tree, shaders, compositor):
    """Make a node that compositors have in common with shaders, in most versions of Blender."""
    old = OLD_COMPOSITOR and tree.bl_idname == COMPOSITOR
    return tree.nodes.new(compositor if old else shaders)


def _sum(tree, total, piece, index):
    add = _shared_node(tree, "ShaderNodeMix", "CompositorNodeMixRGB")
    add.location = (500 + 200 * index, 0)
    if add.bl_idname == "ShaderNodeMix":
        add.data_type = "RGBA"
    add.blend_type = "ADD"
    next(s for s in add.inputs if s.type == "VALUE" and s.enabled).default_value = 1.0
    first, second = _colors(add.inputs)
    tree.links.new(total, first)
    tree.links.new(piece, second)
    return _colors(add.outputs)[0]


def _multiplied(tree, color, matrix, left):
    """The photo's primaries to the config's: nine multiplications, since no node is a matrix."""
    prefix = _PREFIX[tree.bl_idname]
    split = tree.nodes.new(f"{prefix}SeparateColor")
    join = tree.nodes.new(f"{prefix}CombineColor")
    split.location, join.location = (left, 0), (left + 800, 0)
    tree.links.new(color, _colors(split.inputs)[0])
    for row, factors in enumerate(matrix):
        total = None
        for column, factor in enumerate(factors):
            math = _shared_node(tree, "ShaderNodeMath", "CompositorNodeMath")
            math.operation = "MULTIPLY_ADD"
            math.location = (left + 200 * (column + 1), -200 * row)
            math.inputs[1].default_value, math.inputs[2].default_value = factor, 0.0
            tree.links.new(split.outputs[column], math.inputs[0])
            if total is not None:
                tree.links.new(total, math.inputs[2])
            total = math.outputs[0]
        tree.links.new(total, join.inputs[row])
    return _colors(join.outputs)[0]


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


def _fill_piece(mapping, rows, piece, *, shader):
    first, last = piece
    places, curves = _sampled(rows, first, last)
    codes = places / (len(rows) - 1)
    mapping.use_clip = False
    mapping.extend = "HORIZONTAL"  # as OCIO does outside of a LUT's domain
    # Though nothing is clipped: the samples are spread over the clipping region.
    mapping.clip_max_x, mapping.clip_min_x = codes[-1], codes[0]
    if shader:
        # The curve of all channels stays straight, but must end here too: Cycles spreads its
        # samples over what all four curves span. It is asked first there, in the compositor last.
        for point, code in zip(mapping.curves[3].points, (codes[0], codes[-1]), strict=True):
            point.location = (code, code)
    rises = [curve - curve[0] if first else curve for curve in curves]
    if OLD_COMPOSITOR and not shader:
        rises = _within_master(mapping.curves[3].points, rises, codes[-1] - codes[0])
    for channel, linear in enumerate(rises):
        points = mapping.curves[channel].points
        points[0].location, points[-1].location = (codes[0], linear[0]), (codes[-1], linear[-1])
        for place in zip(codes[1:-1], linear[1:-1], strict=True):
            points.new(*place)
        for point in points:
            point.handle_type = "VECTOR"
    mapping.update()


def _within_master(points, rises, width):
    """Divide a piece by what the curve of all channels then multiplies it with."""
    steep = max(1.0, max(rise[-1] for rise in rises) / width)
    points[-1].location = (1.0, steep)
    for point in points:
        point.handle_type = "VECTOR"
    return [rise / steep for rise in rises]
