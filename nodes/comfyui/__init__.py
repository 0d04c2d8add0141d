"""ComfyUI: Linearize Photo, Apply LUT, Encode and Save EXR as nodes.

Put this folder into ComfyUI's `custom_nodes` and install facecrf-ocio into ComfyUI's Python.
Images are float32 (batch, height, width, channel) as everywhere in ComfyUI; values above 1 are
kept.
"""

from .image_nodes import ApplyLUT, Encode, LinearizePhoto, SaveEXR

NODE_CLASS_MAPPINGS = {
    "FaceCRFLinearizePhoto": LinearizePhoto,
    "FaceCRFApplyLUT": ApplyLUT,
    "FaceCRFEncode": Encode,
    "FaceCRFSaveEXR": SaveEXR,
}
NODE_DISPLAY_NAME_MAPPINGS = {
    "FaceCRFLinearizePhoto": "Linearize Photo",
    "FaceCRFApplyLUT": "Apply LUT",
    "FaceCRFEncode": "Encode",
    "FaceCRFSaveEXR": "Save EXR",
}
