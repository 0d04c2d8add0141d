"""
A folder of photos
==================

Batch, verify, and what was found in the manifest.
"""

import shutil
import sqlite3
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.cbook
from PIL import Image

facecrf = [sys.executable, "-c", "from facecrf_ocio.cli.facecrf import main; main()"]
with tempfile.TemporaryDirectory() as name:
    photos, luts = Path(name) / "photos", Path(name) / "luts"
    (photos / "1983").mkdir(parents=True)
    portrait = matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)
    shutil.copy(portrait, photos / "1983" / "hopper.jpg")
    Image.new("RGB", (64, 64), "gray").save(photos / "wall.png")

    subprocess.run([*facecrf, "batch", photos, "-o", luts, "--jobs", "1"], check=True)
    subprocess.run([*facecrf, "verify", luts], check=True)
    manifest = sqlite3.connect(luts / "facecrf-manifest.sqlite")
    for row in manifest.execute("SELECT name, outcome, verdict, reason FROM photos"):
        print(*row, sep=" | ")
    manifest.close()
