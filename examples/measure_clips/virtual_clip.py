"""A clip of which everything is known: a camera that moves, meters anew and compresses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio.benchmark.virtual_camera import FULL_WELL_ISO_100, READ_NOISE
from facecrf_ocio.errors import OutputError, SettingsError
from facecrf_ocio.values import Float

Image = npt.NDArray[np.float32]
Codes = npt.NDArray[np.uint8]

RATE = 24  # [1/s]
_WINDOW = 0.9  # of the scene's sides that a frame shows
_ROAM = 0.03  # of the sides: how far the window strays from the middle
_ZOOM = 0.03  # by which it grows and shrinks
_FACE_WHITE = 0.6  # [1] linear light of the scene's bright parts at the mean exposure
_LEVELS = 65536  # of linear light
_QUALITY = 90  # of JPEG frames
_TIME_S, _SHUTTER = 1 / 60, 0.02  # [s] mean exposure time, [stop] how far a shutter strays
_MEGABIT = 1_000_000
_STEPS = 4  # levels of an exposure that jumps
WANDERING, EVEN, STEPS = "wandering", "even", "steps"


@dataclass(frozen=True, slots=True)
class Take:
    """How a clip is taken.

    Attributes
    ----------
    mbits
        [Mbit/s] of H.264; None for a sequence of images.
    swing
        [stop] from the least to the largest exposure.
    drift
        RMSE between the curves of the first and the last frame.
    frames
        How many.
    iso
        Sensitivity whose noise is added.
    told
        Whether EXIF of JPEGs tells the exposure times, which shutters keep within 0.02 stops.
    lossless
        Whether images are PNGs and no JPEGs.
    course
        How exposure goes: `wandering`, `even` (it only rises or only falls) or `steps` (it jumps
        a few times, as a camera does that meters anew now and then).
    megapixels
        Of a frame. Of half a megapixel faces have 300 px and more, and clips take seconds.
    """

    mbits: float | None
    swing: float = 0.0
    drift: float = 0.0
    frames: int = 24
    iso: float = 400.0
    told: bool = False
    lossless: bool = False
    course: str = WANDERING
    megapixels: float = 0.5


def take_clip(
    scene: Image,
    curves: tuple[Float, Float],
    take: Take,
    generator: np.random.Generator,
    folder: Path,
) -> Path:
    """Write a clip into a folder; returns the video file, or the folder of images.

    Parameters
    ----------
    scene
        (H, W, 3) relative linear light.
    curves
        (K,) inverse responses of the first and of the last frame, between which it goes evenly.
    take
        How.
    generator
        Source of path, exposure and noise.
    folder
        Where to.
    """
    times = np.linspace(0.0, 1.0, take.frames)
    stops = take.swing * _course(take.course, times, generator) / 2.0
    frames = _frames(scene, curves, take, stops, generator)
    if take.mbits is not None:
        return _video(folder / "take.mp4", frames, round(take.mbits * _MEGABIT))
    for number, codes in enumerate(frames):
        shutter = _TIME_S * 2.0 ** float(stops[number] + generator.normal(0.0, _SHUTTER))
        name = f"take.{number + 1:04d}.{'png' if take.lossless else 'jpg'}"
        _image(folder / name, codes, shutter if take.told else 0.0)
    return folder


def _image(path: Path, codes: Codes, exposure_s: float) -> None:
    spec = oiio.ImageSpec(codes.shape[1], codes.shape[0], 3, "uint8")
    if path.suffix == ".jpg":
        spec.attribute("Compression", f"jpeg:{_QUALITY}")
    if exposure_s:
        spec.attribute("ExposureTime", exposure_s)
    written = oiio.ImageOutput.create(str(path))
    if written is None or not written.open(str(path), spec):
        raise OutputError(f"{path}: cannot be written: {oiio.geterror()}")
    written.write_image(np.ascontiguousarray(codes))
    written.close()


def drifted(curve: Float, other: Float, drift: float) -> Float:
    """The curve on the way from one to another that lies `drift` (RMSE) from the first.

    Raises
    ------
    SettingsError
        If the other one lies nearer.
    """
    apart = float(np.sqrt(((other - curve) ** 2).mean()))
    if apart < drift:
        raise SettingsError(f"the curves lie {apart:.3f} apart, less than {drift:g}")
    return curve + (drift / apart) * (other - curve)


def _frames(
    scene: Image,
    curves: tuple[Float, Float],
    take: Take,
    stops: Float,
    generator: np.random.Generator,
) -> Iterator[Codes]:
    scale = np.sqrt(take.megapixels * 1e6 / (scene.shape[0] * scene.shape[1]))
    width, height = (2 * round(scale * side / 2) for side in scene.shape[1::-1])
    bright = max(float(np.quantile(scene, 0.99)), 1e-6)
    light = np.maximum(scene, 0.0) * np.float32(_FACE_WHITE / bright)
    times = np.linspace(0.0, 1.0, take.frames)
    sway = [_path(times, generator) for _ in range(3)]
    well = FULL_WELL_ISO_100 * 100.0 / take.iso
    grid, levels = np.linspace(0.0, 1.0, curves[0].size), np.linspace(0.0, 1.0, _LEVELS)
    for number, time in enumerate(times):
        place = [path[number] for path in sway]
        seen = _window(light, width, height, place) * np.float32(2.0 ** stops[number])
        # Of hundreds of electrons the photon noise is Gaussian.
        noise = np.sqrt(seen / well + (READ_NOISE / well) ** 2)
        counted = seen + noise * generator.standard_normal(seen.shape, np.float32)
        curve = (1.0 - time) * curves[0] + time * curves[1]
        table = np.interp(levels, curve, grid * 255.0)
        codes = np.rint(table).astype(np.uint8)
        yield codes[np.rint(np.clip(counted, 0.0, 1.0) * np.float32(_LEVELS - 1)).astype(np.intp)]


def _course(name: str, times: Float, generator: np.random.Generator) -> Float:
    """(J,) exposures between -1 and 1, both of which are reached."""
    if name == WANDERING:
        return _path(times, generator)
    if name == EVEN:
        return np.asarray(generator.choice([-1.0, 1.0]) * (2.0 * times - 1.0))
    levels = generator.permutation(np.linspace(-1.0, 1.0, _STEPS))
    return np.asarray(levels[np.minimum((times * _STEPS).astype(np.intp), _STEPS - 1)])


def _path(times: Float, generator: np.random.Generator) -> Float:
    """A smooth way between -1 and 1 that touches both."""
    phase, pace = generator.uniform(0.0, 2.0 * np.pi), generator.uniform(0.6, 1.6)
    wave = np.sin(2.0 * np.pi * pace * times + phase)
    return np.asarray(2.0 * (wave - wave.min()) / np.ptp(wave) - 1.0)


def _window(light: Image, width: int, height: int, place: list[float]) -> Image:
    """What a frame shows: a part of the scene, moved by x, y and zoomed by the last of `place`."""
    full_height, full_width = light.shape[:2]
    side = _WINDOW * (1.0 + _ZOOM * place[2])
    step_x, step_y = side * full_width / width, side * full_height / height
    left = (1.0 - side) / 2.0 * full_width + _ROAM * place[0] * full_width
    top = (1.0 - side) / 2.0 * full_height + _ROAM * place[1] * full_height
    warp = np.array([[step_x, 0.0, left], [0.0, step_y, top]])
    flags = cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP
    shown = cv2.warpAffine(light, warp, (width, height), flags=flags, borderMode=cv2.BORDER_REFLECT)
    return np.asarray(np.maximum(shown, 0.0), np.float32)


def _video(path: Path, frames: Iterator[Codes], bits: int) -> Path:
    """H.264 by libx264 through PyAV: 4:2:0, limited range, BT.709, as cameras write it."""
    try:
        import av  # noqa: PLC0415 -- an extra
    except ImportError as error:
        raise SettingsError("videos need PyAV: pip install 'facecrf-ocio[video]'") from error
    with av.open(str(path), "w") as container:
        stream: Any = None
        for codes in frames:
            if stream is None:
                stream = container.add_stream("libx264", rate=Fraction(RATE))
                stream.height, stream.width = codes.shape[:2]
                stream.pix_fmt, stream.bit_rate = "yuv420p", bits
                stream.thread_count = 1  # more of them encode otherwise each time
                stream.codec_context.color_range = 1
                stream.codec_context.colorspace = 1
                # Held as a camera holds it: without, short clips take what they like.
                stream.options = {"maxrate": str(bits), "bufsize": str(bits), "preset": "fast"}
            frame = av.VideoFrame.from_ndarray(codes, format="rgb24").reformat(
                format="yuv420p",
                dst_colorspace="ITU709",
                src_color_range="JPEG",
                dst_color_range="MPEG",
            )
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    return path
