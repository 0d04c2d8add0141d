"""Which of the face mesh's vertices border which feature.

Indices of the MediaPipe face mesh; each tuple walks once around its region. "Right" and "left" are
the subject's, so the right eye is on the left of the photo.
"""

from __future__ import annotations

# Vertices.
RIGHT_EYE = (33, 246, 161, 160, 159, 158, 157, 173, 133, 155, 154, 153, 145, 144, 163, 7)
# Vertices.
LEFT_EYE = (263, 466, 388, 387, 386, 385, 384, 398, 362, 382, 381, 380, 374, 373, 390, 249)

# One ring of vertices further out: the lids up to the crease, where the lashes are.
RIGHT_LIDS = (130, 247, 30, 29, 27, 28, 56, 190, 243, 112, 26, 22, 23, 24, 110, 25)
# Vertices.
LEFT_LIDS = (359, 467, 260, 259, 257, 258, 286, 414, 463, 341, 256, 252, 253, 254, 339, 255)

RIGHT_BROW = (70, 63, 105, 66, 107, 55, 65, 52, 53, 46)  # vertices
LEFT_BROW = (300, 293, 334, 296, 336, 285, 295, 282, 283, 276)  # vertices

# Vertices.
LIPS = (
    *(61, 185, 40, 39, 37, 0, 267, 269, 270, 409, 291),
    *(375, 321, 405, 314, 17, 84, 181, 91, 146),
)

RIGHT_NOSTRIL = (218, 237, 241, 242, 99, 240, 235, 219)  # vertices
LEFT_NOSTRIL = (438, 457, 461, 462, 328, 460, 455, 439)  # vertices

# In front of each ear: their distance is the width of the head whatever its pose.
CHEEK_EDGES = (234, 454)
