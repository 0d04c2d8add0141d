"""The light of a cheek, which portraits are exposed for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from facecrf_ocio.color.primaries import LUMINANCE
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.face.skin_mask import find_skin
from facecrf_ocio.face.view import MIN_SKIN_PIXELS, cut_face
from facecrf_ocio.settings import FaceSettings
from facecrf_ocio.values import Face, InverseCRF, Photo

# Vertices of the face mesh around each cheek, below the eye and beside nose and mouth.
_RIGHT_CHEEK = (50, 101, 36, 205, 187, 123, 117, 118)
_LEFT_CHEEK = (280, 330, 266, 425, 411, 352, 346, 347)  # vertices
_LEAST = MIN_SKIN_PIXELS // 8  # pixels; a cheek is about an eighth of a face's skin


def lit_cheek(photo: Photo, curve: InverseCRF, known: Sequence[Face] = ()) -> float | None:
    """Return the luminance of the brighter cheek of a photo's widest face, white being 1.

    The median of the pixels that have the hue of skin and are neither among the face's darkest nor
    its brightest; None without a face, or if no cheek is in view. Faces of this photo that are
    `known`, with their landmarks, are not sought again.
    """
    settings = FaceSettings()
    faces = [face for face in known if face.landmarks_xyz.size]
    faces = faces or list(find_faces(photo.pixels, settings, most=1).faces)
    if not faces:
        return None
    view = cut_face(photo, max(faces, key=lambda face: face.box_xy[2]), settings)
    diffuse = find_skin(view.encoded, view.geometry.bare_skin, settings).diffuse
    linear = view.encoded if photo.scene_linear else curve.linearize(view.encoded)
    luminance = linear @ LUMINANCE
    sides = [view.within(cheek) & diffuse for cheek in (_RIGHT_CHEEK, _LEFT_CHEEK)]
    seen = [float(np.median(luminance[side])) for side in sides if side.sum() >= _LEAST]
    return max(seen, default=None)
