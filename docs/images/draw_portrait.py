"""Draw grace_hopper.png and show.jpg: the plot and the page of one photo, as a user gets them.

`python docs/images/draw_portrait.py` calibrates matplotlib's portrait of Grace Hopper (US Navy,
public domain) and lets Chromium draw its page, one stop up; Chromium and its driver must be
installed (Debian: chromium-driver).
"""

from __future__ import annotations

import base64
import shutil
import subprocess
import sys
import tempfile
from io import BytesIO
from pathlib import Path

import matplotlib.cbook
from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

HERE = Path(__file__).parent
PLOT_WIDTH = 1400  # pixels, of the 2100 that are written: twice what a page of the docs shows
PAGE_WIDTH, WINDOW_HEIGHT = 1100, 860  # pixels
JPEG_QUALITY = 90  # no rings are seen around letters
BROWSER = ("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars")

PICTURES_SHOWN = """
const shown = arguments[0], twice = () => requestAnimationFrame(() => requestAnimationFrame(shown));
Promise.all([...document.images].map(one => one.decode())).then(twice);
"""


def facecrf(folder: Path, *arguments: str) -> None:
    """Run the command in a folder."""
    program = "from facecrf_ocio.cli.facecrf import main; main()"
    subprocess.run([sys.executable, "-c", program, *arguments], check=True, cwd=folder)


def shoot(page: Path) -> Image.Image:
    """The whole page, its photo one stop up."""
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or shutil.which("google-chrome") or ""
    for argument in BROWSER:
        options.add_argument(argument)
    driver = shutil.which("chromedriver")
    if not options.binary_location or driver is None:
        raise SystemExit("Chromium and its driver are not installed, and draw the page")
    window = webdriver.Chrome(options=options, service=Service(driver))
    try:
        screen = {
            "width": PAGE_WIDTH,
            "height": WINDOW_HEIGHT,
            "deviceScaleFactor": 1,
            "mobile": False,
        }
        window.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
        window.get(page.as_uri())
        window.find_element("xpath", "//button[text()='+1']").click()
        # A busy machine shows the page before its pictures.
        window.execute_async_script(PICTURES_SHOWN)
        # Beyond the window, whose height decides how large pictures are.
        height = window.execute_script("return document.documentElement.scrollHeight")
        clip = {"x": 0, "y": 0, "width": PAGE_WIDTH, "height": height, "scale": 1}
        asked = {"captureBeyondViewport": True, "clip": clip}
        shot = window.execute_cdp_cmd("Page.captureScreenshot", asked)["data"]
        return Image.open(BytesIO(base64.b64decode(shot))).convert("RGB")
    finally:
        window.quit()


def main(folder: Path) -> None:
    """Make both pictures of what is written into a folder."""
    portrait = matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)
    shutil.copy(portrait, folder / "grace_hopper.jpg")
    facecrf(folder, "calibrate", "grace_hopper.jpg", "-o", "luts", "--plot")
    facecrf(folder, "linearize", "grace_hopper.jpg", "-o", "luts/grace_hopper.jpg.exr")
    record = "luts/grace_hopper.jpg.crf.json"
    facecrf(folder, "show", "grace_hopper.jpg", "--record", record, "-o", "page.html")
    plot = Image.open(folder / "luts" / "grace_hopper.jpg.crf.png").convert("RGB")
    size = PLOT_WIDTH, round(plot.height * PLOT_WIDTH / plot.width)
    plot.resize(size, Image.Resampling.LANCZOS).save(HERE / "grace_hopper.png", optimize=True)
    shoot(folder / "page.html").save(HERE / "show.jpg", quality=JPEG_QUALITY)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        main(Path(name))
