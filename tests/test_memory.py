"""What a photo of 24 megapixels takes, measured in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import cv2
import matplotlib.cbook
import numpy as np
import pytest

# Not getrusage: its peak starts with that of the process that this one was forked from.
STATUS = Path("/proc/self/status")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not STATUS.exists(), reason="the peak is read from Linux's /proc"),
]

MOST = 600  # [MB] what a worker of an archive may take
WIDTH, HEIGHT = 4472, 5367

WORK = """
import sys
from pathlib import Path
from facecrf_ocio import calibrate, read_photo
from facecrf_ocio.image.linearize import write_linear
photo = read_photo(sys.argv[1])
estimate = calibrate(photo, estimator="auto")
write_linear(Path(sys.argv[2]), photo, estimate)
print(photo.bit_depth, photo.shape, estimate.outcome, sep="|")
print(next(line for line in open("/proc/self/status") if line.startswith("VmHWM")).split()[1])
"""


@pytest.mark.parametrize(("name", "dtype"), [("a.jpg", np.uint8), ("a.tif", np.uint16)])
def test_calibrating_and_linearizing_24_megapixels(tmp_path: Path, name: str, dtype: type) -> None:
    portrait = cv2.imread(str(matplotlib.cbook.get_sample_data("grace_hopper.jpg", False)))
    large = cv2.resize(portrait, (WIDTH, HEIGHT), interpolation=cv2.INTER_CUBIC).astype(np.float32)
    large += np.random.default_rng(0).normal(0, 3, (HEIGHT, WIDTH, 1)).astype(np.float32)
    codes = np.clip(large, 0, 255) * (np.iinfo(dtype).max / 255)
    cv2.imwrite(str(tmp_path / name), codes.astype(dtype))
    command = [sys.executable, "-c", WORK, str(tmp_path / name), str(tmp_path / "a.exr")]
    one_thread = {**os.environ, "OMP_NUM_THREADS": "1"}  # as an archive's workers have it
    result = subprocess.run(command, check=True, capture_output=True, text=True, env=one_thread)
    told, peak = result.stdout.splitlines()
    assert told == f"{8 * np.dtype(dtype).itemsize}|{(HEIGHT, WIDTH, 3)}|calibrated"
    assert int(peak) / 1024 < MOST
