"""The nodes. Torch is ComfyUI's own; facecrf_ocio comes in when a node runs first."""

from pathlib import Path

import numpy as np
import torch

CATEGORY = "image/color"
_ON_GRID = 1e-4  # [code value] by which 8-bit pixels differ from whole codes


class NodeError(Exception):
    """What ComfyUI shows on the node: one sentence."""


def _photos(image):
    """Photos of a batch, (B, H, W, 3 or 4); whole codes of 8 bits are taken as such."""
    from facecrf_ocio import Photo

    for one in image.detach().cpu().numpy().astype(np.float32):
        color = np.ascontiguousarray(one[..., :3])
        codes = color * 255.0
        whole = np.abs(codes - np.rint(codes)).max() < _ON_GRID
        high = float(color.max()) > 1.0 or float(color.min()) < 0.0
        yield Photo(color, bit_depth=8 if whole else None, scene_linear=high)


def _batch(arrays):
    return torch.from_numpy(np.stack(arrays).astype(np.float32))


def _guarded(work):
    """The node's method, with our own errors as messages."""

    def run(self, **inputs):
        try:
            from facecrf_ocio.errors import FaceCRFError
        except ImportError as error:
            raise NodeError(
                "facecrf-ocio is not installed in ComfyUI's Python; run: "
                "python -m pip install facecrf-ocio"
            ) from error
        try:
            return work(self, **inputs)
        except FaceCRFError as error:
            raise NodeError(str(error)) from error

    return run


class LinearizePhoto:
    """Estimate the camera's curve from the faces in a photo, and undo it."""

    CATEGORY = CATEGORY
    FUNCTION = "run"
    RETURN_TYPES = ("IMAGE", "FACECRF_CURVE", "FLOAT", "STRING")
    RETURN_NAMES = ("linear", "curve", "expected_error_stops", "says")

    @classmethod
    def INPUT_TYPES(cls):  # noqa: N802 -- ComfyUI's name
        return {
            "required": {
                "image": ("IMAGE",),
                "one_curve": ("BOOLEAN", {"default": True}),
                "prior": (["auto", "modern", "dorf"],),
                "without_a_face": (["stop", "srgb", "mean"],),
            }
        }

    @_guarded
    def run(self, image, one_curve=True, prior="auto", without_a_face="stop"):
        """Give linear light, the curve (the last photo's where each has one), what to expect."""
        from facecrf_ocio import calibrate, calibrate_together

        photos = list(_photos(image))
        if any(photo.scene_linear for photo in photos):
            raise NodeError("the image has values outside of 0 to 1, so it is linear already")
        fallback = "none" if without_a_face == "stop" else without_a_face
        if one_curve and len(photos) > 1:
            together = calibrate_together(photos, prior=prior).estimate
            estimates = [together] * len(photos)
            if not any(one.faces for one in estimates):
                estimates = [calibrate(photos[0], fallback=fallback)] * len(photos)
        else:
            estimates = [calibrate(p, prior=prior, fallback=fallback) for p in photos]
        for estimate in estimates:
            if estimate.found is None:
                raise NodeError(f"{estimate.reason}; {estimate.remedy}")
        linear = [e.curve.linearize(p.encoded) for e, p in zip(estimates, photos, strict=True)]
        last = estimates[-1]
        told = last.confidence
        expected = -1.0 if told is None or told.in_stops is None else float(told.in_stops.mid)
        verdict = "" if told is None else f" ({told.verdict})"
        return _batch(linear), last.curve, expected, f"{last.outcome}{verdict}: {last.reason}"


class ApplyLUT:
    """Send images through any LUT file that OpenColorIO reads."""

    CATEGORY = CATEGORY
    FUNCTION = "run"
    RETURN_TYPES = ("IMAGE",)

    @classmethod
    def INPUT_TYPES(cls):  # noqa: N802 -- ComfyUI's name
        return {"required": {"image": ("IMAGE",), "lut": ("STRING", {"default": ""})}}

    @_guarded
    def run(self, image, lut):
        """Give what the LUT makes of the values; those outside of its domain are clamped."""
        from facecrf_ocio.image.apply import apply_lut

        return (_batch([apply_lut(photo, Path(lut)) for photo in _photos(image)]),)


class Encode:
    """Bring linear light back to the code values of the camera that a curve is of."""

    CATEGORY = CATEGORY
    FUNCTION = "run"
    RETURN_TYPES = ("IMAGE",)

    @classmethod
    def INPUT_TYPES(cls):  # noqa: N802 -- ComfyUI's name
        return {"required": {"linear": ("IMAGE",), "curve": ("FACECRF_CURVE",)}}

    @_guarded
    def run(self, linear, curve):
        """Give code values, [0, 1]: light above white is clipped, as that camera would."""
        arrays = linear.detach().cpu().numpy()[..., :3]
        return (_batch([curve.encode(one) for one in arrays]),)


class SaveEXR:
    """Write linear images as scene-linear EXR, values above 1 and all."""

    CATEGORY = CATEGORY
    FUNCTION = "run"
    RETURN_TYPES = ()
    OUTPUT_NODE = True

    @classmethod
    def INPUT_TYPES(cls):  # noqa: N802 -- ComfyUI's name
        return {
            "required": {
                "linear": ("IMAGE",),
                "name": ("STRING", {"default": "linear"}),
                "half": ("BOOLEAN", {"default": True}),
            }
        }

    @_guarded
    def run(self, linear, name, half=True):
        """Write NAME.0001.exr and so on to ComfyUI's output folder, replacing none."""
        from facecrf_ocio import Photo, __version__
        from facecrf_ocio.image.apply import write_exr

        folder, written = _output_folder(), []
        number = 1
        for pixels in linear.detach().cpu().numpy()[..., :3]:
            while (folder / f"{name}.{number:04d}.exr").exists():
                number += 1
            target = folder / f"{name}.{number:04d}.exr"
            target.parent.mkdir(parents=True, exist_ok=True)
            array = np.ascontiguousarray(pixels, np.float32)
            photo = Photo(array, scene_linear=True)
            provenance = {"node": "ComfyUI Save EXR", "version": __version__}
            exr = write_exr(target, array, photo, provenance=provenance, half=half)
            written += [str(exr.path), *exr.notes]
        return {"ui": {"text": written}}


def _output_folder():
    """ComfyUI's own, or the working folder outside of it."""
    try:
        import folder_paths  # ComfyUI's module
    except ImportError:
        return Path.cwd()
    return Path(folder_paths.get_output_directory())
