"""The shipped neural networks, loaded on first use and run by OpenCV."""

from __future__ import annotations

import threading
from functools import cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import FaceCRFError, OutputError
from facecrf_ocio.files.content import sha256_of
from facecrf_ocio.values import Float

MODELS = Path(__file__).parent / "models"

# From OpenCV 5 on, only the classic engine runs these models, and only the overload that takes a
# path listens to the choice; OpenCV 4 has that engine alone and no such argument.
_ENGINE: dict[str, int] = (
    {"engine": cv2.dnn.ENGINE_CLASSIC} if int(cv2.__version__.split(".")[0]) >= 5 else {}
)


@cache
def model_path(file: str) -> Path:
    """Path of a file in `models/`, whose bytes are those that ship.

    Raises
    ------
    FaceCRFError
        If it is not there, or another: libraries parse such files with little suspicion.
    """
    path = MODELS / file
    try:
        listed = (MODELS / "SHA256SUMS").read_text(encoding="ascii").split()
        known = dict(zip(listed[1::2], listed[::2], strict=True)).get(file)
        genuine = known is not None and sha256_of(path) == known
    except (OSError, ValueError, OutputError):
        genuine = False
    if not genuine:
        raise FaceCRFError(f"{path}: is not the model that ships; install facecrf-ocio again")
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
        self._net: Any = cv2.dnn.readNetFromTFLite(str(model_path(file)), **_ENGINE)
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
