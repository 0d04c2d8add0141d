"""An image of Blender's as a file that the command can read."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy

from .color_space import CODES_OF, painted_copy
from .command import CommandError


@contextmanager
def photo_file(image: bpy.types.Image) -> Iterator[Path]:
    """The file an image comes from; of one that is packed, painted or generated, a copy.

    Raises
    ------
    CommandError
        If the image is no single photo in code values.
    """
    image = _original(image)
    if image.source not in ("FILE", "GENERATED"):
        raise CommandError(f"{image.name}: is a {image.source.lower()}; choose a single photo")
    if image.is_float and image.source == "GENERATED":
        raise CommandError(f"{image.name}: holds floats, which are linear light already")
    if image.is_float and image.is_dirty:
        raise CommandError(f"{image.name}: was painted on; save it first by Image > Save")
    path = Path(bpy.path.abspath(image.filepath, library=image.library))
    if image.packed_file is None and image.source == "FILE" and not image.is_dirty:
        if not image.filepath or not path.is_file():
            raise CommandError(f"{path}: is not there; find it by File > External Data")
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="facecrf-") as folder:
        stem = "".join(c if c.isalnum() else "_" for c in Path(image.name).stem) or "image"
        if image.packed_file is not None and not image.is_dirty:
            copy = Path(folder) / f"{stem}{path.suffix or '.png'}"
            copy.write_bytes(image.packed_file.data)
        else:
            copy = Path(folder) / f"{stem}.png"
            _save(image, copy)
        yield copy


def _save(image, path):
    # A copy is saved, since Blender makes the file that it wrote the image's own.
    copy = painted_copy(image)
    copy.file_format = "PNG"
    copy.save(filepath=str(path))
    bpy.data.images.remove(copy)


def _original(image):
    return bpy.data.images.get(image.get(CODES_OF, ""), image)
