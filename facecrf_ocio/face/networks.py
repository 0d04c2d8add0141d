"""The shipped neural networks, loaded on first use and run by OpenCV."""

from __future__ import annotations

import threading
from functools import cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Float

MODELS = Path(__file__).parent / "models"

# From OpenCV 5 on, only the classic engine runs these models, and only the overload that takes a
# path listens to the choice; OpenCV 4 has that engine alone and no such argument.
_ENGINE: dict[str, int] = (
    {"engine": cv2.dnn.ENGINE_CLASSIC} if int(cv2.__version__.split(".")[0]) >= 5 else {}
)


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
        self._net: Any = cv2.dnn.readNetFromTFLite(str(MODELS / file), **_ENGINE)
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
