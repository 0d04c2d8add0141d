"""Draw terminal.png: what three commands print in a terminal of 104 columns.

`python docs/images/draw_terminal.py` runs them on matplotlib's portrait of Grace Hopper (US Navy,
public domain) and on versions of it, of which the last file is cut short. Photos a second, which
tell of the machine, are left out.
"""

from __future__ import annotations

import os
import pty
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.cbook
from PIL import Image, ImageDraw, ImageFont

HERE = Path(__file__).parent
COLUMNS, LINE, MARGIN, LETTERS = 104, 19, 8, 15  # characters; pixels
COMMANDS = (
    "facecrf calibrate grace_hopper.jpg -o luts",
    "facecrf linearize grace_hopper.jpg -o luts --exposure skin",
    "facecrf batch photos -o archive",
)
RATE = re.compile(r", [\d.]+/s")
GROUND, PRINTED, TYPED = (23, 24, 28), (228, 228, 228), (255, 255, 255)


def said(folder: Path, command: str) -> list[str]:
    """The lines that a command leaves on a terminal."""
    program = "from facecrf_ocio.cli.facecrf import main; main()"
    seen, screen = pty.openpty()
    settings = {**os.environ, "TERM": "dumb", "NO_COLOR": "1", "COLUMNS": str(COLUMNS)}
    run = subprocess.Popen(
        [sys.executable, "-c", program, *command.split()[1:]],
        cwd=folder,
        stdin=screen,
        stdout=screen,
        stderr=screen,
        env=settings,
    )
    os.close(screen)
    text = b""
    while True:
        try:
            part = os.read(seen, 4096)
        except OSError:  # how Linux ends what nobody writes to anymore
            break
        if not part:
            break
        text += part
    run.wait()
    lines = text.decode().replace("\r\n", "\n").rstrip("\n").split("\n")
    shown = (RATE.sub("", line.rpartition("\r")[2]) for line in lines)  # behind bars of progress
    return [line for line in shown if line.strip()]


def main(folder: Path) -> None:
    """Run the commands in a folder, and draw them and what they say."""
    portrait = folder / "grace_hopper.jpg"
    shutil.copy(matplotlib.cbook.get_sample_data(portrait.name, asfileobj=False), portrait)
    photos = folder / "photos"
    photos.mkdir()
    with Image.open(portrait) as image:
        image.save(photos / "a.jpg", quality=92)
        image.transpose(Image.Transpose.FLIP_LEFT_RIGHT).save(photos / "b.jpg", quality=92)
        image.resize((image.width * 3 // 4, image.height * 3 // 4)).save(photos / "c.jpg")
    content = portrait.read_bytes()
    (photos / "d.jpg").write_bytes(content[: len(content) // 2])
    lines: list[tuple[str, bool]] = []
    for command in COMMANDS:
        lines += [(f"$ {command}", True), *((line, False) for line in said(folder, command))]
        lines.append(("", False))
    draw(lines[:-1])


def draw(lines: list[tuple[str, bool]]) -> None:
    """Write the picture; what was typed is bold."""
    fonts = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
    plain, bold = (
        ImageFont.truetype(fonts / f"DejaVuSansMono{weight}.ttf", LETTERS)
        for weight in ("", "-Bold")
    )
    width = round(max(bold.getlength(line) for line, _ in lines)) + 2 * MARGIN
    image = Image.new("RGB", (width, LINE * len(lines) + 2 * MARGIN), GROUND)
    pen = ImageDraw.Draw(image)
    for row, (line, typed) in enumerate(lines):
        place = MARGIN, MARGIN + LINE * row
        pen.text(place, line, fill=TYPED if typed else PRINTED, font=bold if typed else plain)
    image.quantize(32).save(HERE / "terminal.png", optimize=True)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        main(Path(made))
