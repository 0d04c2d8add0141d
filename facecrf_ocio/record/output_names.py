"""How the files made of a photo are named: its whole name, then what each of them is.

`IMG_1.jpg` gets `IMG_1.jpg.cube`, `IMG_1.jpg.crf.json`, `IMG_1.jpg.exr`, from every command. So
`IMG_1.jpg` and `IMG_1.dng` of one exposure, or a PNG beside a JPEG, never write the same files, and
none of them can be the photo itself. darktable names its records beside photos so for that reason.
"""

from __future__ import annotations

from pathlib import Path, PurePath

from facecrf_ocio.errors import OutputError

RECORD = ".crf.json"
PLOT = ".crf.png"
PAGE = ".crf.html"
EXR = ".exr"
HDR = ".hdr.exr"  # of the bracket that begins with the photo


def output_name(name: str, suffix: str) -> str:
    """Name of one file made of a photo.

    Parameters
    ----------
    name
        The photo's, or a clip's; folders in front of it stay.
    suffix
        What the file is: one of the suffixes above, or a LUT's ending as in `format_table`, with
        or without its dot.
    """
    return f"{name}.{suffix.removeprefix('.')}"


def output_path(folder: Path, photo: PurePath | str, suffix: str) -> Path:
    """Return where a file made of a photo, or of a clip of that name, lies in a folder."""
    return folder / output_name(PurePath(photo).name, suffix)


def names_exr(path: PurePath) -> bool:
    """Whether a name is one of an EXR, which OpenImageIO and hosts tell by its ending."""
    return path.suffix.lower() == EXR


def require_exr_name(path: PurePath) -> None:
    """Raise OutputError unless a name is one of an EXR."""
    if not names_exr(path):
        raise OutputError(f"{path}: is no name of an EXR; let it end in {EXR}")
