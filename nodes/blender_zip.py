"""Build the Blender extension: `python nodes/blender_zip.py [FOLDER]` writes its zip there.

Install the zip in Blender by Edit > Preferences > Get Extensions > Install from Disk.
"""

from __future__ import annotations

import re
import sys
import zipfile
from pathlib import Path

SOURCE = Path(__file__).parent / "blender"
_SUFFIXES = (".py", ".toml")
_LONGEST_AGO = (1980, 1, 1, 0, 0, 0)  # zip's first date: the same files make the same bytes


def build(folder: Path) -> Path:
    """Write the extension's zip into a folder, which is made if missing, and return its path."""
    manifest = (SOURCE / "blender_manifest.toml").read_text(encoding="utf-8")
    name, version = (
        re.findall(rf'^{key} = "(.+)"', manifest, re.MULTILINE)[0] for key in ("id", "version")
    )
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}-{version}.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as package:
        for file in sorted(SOURCE.iterdir()):
            if file.suffix in _SUFFIXES or file.name == "LICENSE":
                entry = zipfile.ZipInfo(file.name, _LONGEST_AGO)
                entry.compress_type = zipfile.ZIP_DEFLATED
                package.writestr(entry, file.read_bytes())
    return path


if __name__ == "__main__":
    print(build(Path(sys.argv[1] if len(sys.argv) > 1 else ".")))
