"""Draw archive_report.png: the report of a made-up archive, as a browser shows it.

`python docs/images/draw_archive_report.py [FOLDER]` makes the archive in FOLDER (a temporary one by
default), which the page names; Chromium must be installed. One photo is real (matplotlib's portrait
of Grace Hopper, US Navy, public domain), the others are rendered heads through three gamma curves
with a toe, each a made-up camera's, and files as archives hold them: cut short, empty, no face,
twice the same.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import matplotlib.cbook
import numpy as np
from PIL import Image

from facecrf_ocio.synthetic import SyntheticSpec, encode, render_face
from facecrf_ocio.values import InverseCRF

PICTURE = Path(__file__).with_name("archive_report.png")
SIZE = 1400, 2030  # pixels of the page
SCALE = 0.8  # pixels of the picture for one of the page
# Camera, exponent, share of light's toe, photos of it.
CAMERAS = (("Camera A", 2.0, 0.02, 7), ("Camera B", 2.4, 0.0, 5), ("Camera C", 2.8, 0.03, 4))
FULL_WELL = 20_000  # electrons: some ISO 200
LARGER = 3  # than the render, whose faces are small


def response(exponent: float, toe: float) -> InverseCRF:
    """Linear light at 4096 encoded values."""
    grid = np.linspace(0.0, 1.0, 4096)
    linear = (1.0 - toe) * grid**exponent + toe * grid
    return InverseCRF(grid, np.tile(linear, (3, 1)))


def take(path: Path, seed: int, model: str, curve: InverseCRF) -> None:
    """Write one head, with the noise of photons, as a JPEG with EXIF."""
    generator = np.random.default_rng(seed)
    light = render_face(SyntheticSpec(seed=seed)).linear.astype(np.float32)
    light = cv2.resize(light, None, fx=LARGER, fy=LARGER, interpolation=cv2.INTER_CUBIC)
    light = np.clip(light * 2.0 ** generator.normal(0.0, 0.5), 0.0, 1.0)
    light += generator.standard_normal(light.shape) * np.sqrt(light / FULL_WELL)
    codes = np.rint(255.0 * encode(np.clip(light, 0.0, 1.0), curve)).astype(np.uint8)
    exif = Image.Exif()
    exif[0x010F], exif[0x0110] = "Made up", model
    Image.fromarray(codes).save(path, quality=94, exif=exif)


def fill(photos: Path) -> None:
    """Make the archive."""
    for folder in ("1998", "studio", "travel"):
        (photos / folder).mkdir(parents=True)
    portrait = matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)
    shutil.copy(portrait, photos / "1998" / "grace_hopper.jpg")
    seed = 0
    for model, exponent, toe, count in CAMERAS:
        for _ in range(count):
            folder = "studio" if model == "Camera A" else "travel"
            take(photos / folder / f"head {seed}.jpg", seed, model, response(exponent, toe))
            seed += 1
    shutil.copy(photos / "studio" / "head 0.jpg", photos / "studio" / "copy of head 0.jpg")
    y, x = np.mgrid[0:600, 0:600] / 600.0
    ramp = np.stack([x * (1.0 - x) + 0.2 * y, 0.3 + 0.5 * x, 1.0 - y], axis=2)
    Image.fromarray((255 * np.clip(ramp, 0, 1)).astype(np.uint8)).save(photos / "landscape.png")
    whole = (photos / "landscape.png").read_bytes()
    (photos / "cut.png").write_bytes(whole[: len(whole) // 2])
    (photos / "empty.jpg").write_bytes(b"")


def shoot(page: Path) -> None:
    """Let Chromium draw the top of a page, with its folded tables open."""
    text = page.read_text(encoding="utf-8").replace("<details>", "<details open>", 1)
    opened = page.with_name("opened.html")
    opened.write_text(text, encoding="utf-8")
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None:
        raise SystemExit("Chromium is not installed, and draws the page")
    options = ("--headless", "--no-sandbox", "--hide-scrollbars", "--virtual-time-budget=8000")
    window = f"--window-size={SIZE[0]},{SIZE[1]}"
    shot = f"--screenshot={PICTURE}"
    scale = f"--force-device-scale-factor={SCALE}"
    # What it says of a desktop that is not there is of no use.
    command = [browser, *options, window, scale, shot, opened.as_uri()]
    subprocess.run(command, check=True, capture_output=True)


def main(archive: Path) -> None:
    """Make the archive in a folder, and the picture of its report."""
    photos, luts = archive / "photos", archive / "luts"
    fill(photos)
    facecrf = [sys.executable, "-c", "from facecrf_ocio.cli.facecrf import main; main()"]
    # Some of the files cannot be read, which is the exit code's to say.
    subprocess.run([*facecrf, "batch", photos, "-o", luts, "--pool", "camera"], check=False)
    subprocess.run([*facecrf, "report", luts], check=True)
    shoot(luts / "facecrf-report.html")


if __name__ == "__main__":
    if sys.argv[1:]:
        main(Path(sys.argv[1]))
    else:
        with tempfile.TemporaryDirectory() as name:
            main(Path(name))
