"""The shipped neural networks, loaded on first use and run by OpenCV."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import FaceCRFError, OutputError
from facecrf_ocio.files.content import sha256_of
from facecrf_ocio.values import Float

MODELS = Path(__file__).parent / "models"
_HALVES = ".halves"
"""Ends the name of weights in half precision whose bytes are stored all low ones first, then all
high ones: a wheel compresses them by 200 kB better."""

# From OpenCV 5 on, only the classic engine runs these models, and only the overload that takes a
# path listens to the choice; OpenCV 4 has that engine alone and no such argument.
_ENGINE: dict[str, int] = (
    {"engine": cv2.dnn.ENGINE_CLASSIC} if int(cv2.__version__.split(".")[0]) >= 5 else {}
)


@contextmanager
def model_file(file: str) -> Iterator[Path]:
    """A file of `models/` as its makers published it, byte for byte, for as long as it is read.

    Raises
    ------
    FaceCRFError
        If it is not there, or another: libraries parse such files with little suspicion.
    """
    halves = MODELS / f"{file}{_HALVES}"
    if not halves.exists():
        yield _genuine(MODELS / file)
        return
    with TemporaryDirectory(prefix="facecrf-") as folder:
        whole = Path(folder) / file
        low, high = np.fromfile(halves, np.uint8).reshape(2, -1)
        np.stack((low, high), axis=1).tofile(whole)
        yield _genuine(whole)


def _genuine(path: Path) -> Path:
    """The path, if `SHA256SUMS` lists what is there."""
    try:
        listed = (MODELS / "SHA256SUMS").read_text(encoding="ascii").split()
        known = dict(zip(listed[1::2], listed[::2], strict=True)).get(path.name)
        genuine = known is not None and sha256_of(path) == known
    except (OSError, ValueError, OutputError):
        genuine = False
    if not genuine:
        told = MODELS / path.name
        raise FaceCRFError(f"{told}: is not the model that ships; install facecrf-ocio again")
    return path


class Network:
    """A TensorFlow Lite model that takes one square RGB image.

    Parameters
    ----------
    file
        Name of a file in `models/`.
    outputs
        Names of the output tensors wanted.
    """

    def __init__(self, file: str, *outputs: str) -> None:
        with model_file(file) as path:
            self._net: Any = cv2.dnn.readNetFromTFLite(str(path), **_ENGINE)
        # What follows a convolution runs faster behind it than within: a fourteenth of the whole
        # for landmarks, to the same numbers.
        self._net.enableFusion(False)
        self._outputs = outputs
        self._lock = threading.Lock()  # a network keeps its input between two calls

    def run(self, pixels: npt.NDArray[np.float32]) -> tuple[Float, ...]:
        """Evaluate (H, W, 3) pixels, scaled as the model wants them; outputs in the order named."""
        blob = np.ascontiguousarray(pixels.transpose(2, 0, 1)[None])
        with self._lock:
            self._net.setInput(blob)
            return tuple(np.array(output) for output in self._net.forward(self._outputs))


@cache
def load_network(file: str, *outputs: str) -> Network:
    """Return the network, read from disk once per process."""
    return Network(file, *outputs)
