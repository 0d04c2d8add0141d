"""Names that OpenColorIO takes, and patterns by which it tells photos apart."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from facecrf_ocio.ocio_config.find import PhotoLut

# A photo's suffix in a LUT's name, as a batch over an archive names its files.
_PHOTO = re.compile(r"\.(jpe?g|jpe|jp2|png|tiff?|webp|bmp|gif|hei[cf]|avif|psd|tga|p[pgn]m)", re.I)


@dataclass(frozen=True, slots=True)
class Entry:
    """One LUT of a config, its name there, and the photos it is for.

    Attributes
    ----------
    lut
        The LUT.
    name
        Of letters, digits and `_.-`; unlike any other's even without regard to case.
    pattern
        Regular expression (ECMAScript) of the photos' paths.
    folders
        How many folders the pattern asks for.
    """

    lut: PhotoLut
    name: str
    pattern: str
    folders: int = 0

    @property
    def file(self) -> str:
        """Name of the LUT's copy."""
        return f"{self.name}{self.lut.path.suffix.lower()}"


def name_luts(luts: Sequence[PhotoLut], taken: Sequence[str] = ()) -> tuple[Entry, ...]:
    """Name the LUTs.

    Photos of one name in several folders are told apart by as many folders as it takes, which are
    called as those of the LUTs are.
    """
    alike: dict[str, list[PhotoLut]] = {}
    for lut in luts:
        alike.setdefault(lut.stem, []).append(lut)
    depths = {stem: _depth(group) for stem, group in alike.items()}
    used = {name.casefold() for name in taken}
    entries = []
    for lut in luts:
        depth = depths[lut.stem]
        folders = lut.folders[-depth:] if depth else ()
        wanted = "facecrf_" + safe("_".join((*folders, lut.stem)))
        name, number = wanted, 2
        while name.casefold() in used:
            name, number = f"{wanted}_{number}", number + 1
        used.add(name.casefold())
        places = "".join(_literal(folder) + r"[/\\]" for folder in folders)
        entries.append(Entry(lut, name, rf"(.*[/\\])?{places}{_file_names(lut)}", len(folders)))
    return tuple(entries)


def safe(text: str) -> str:
    """Without what OpenColorIO, shells or file systems give a meaning; letters of any script."""
    return re.sub(r"[^\w.-]", "_", text)[:60]


def _depth(luts: Sequence[PhotoLut]) -> int:
    """How many folders, counted from the file, differ in all LUTs of one name."""
    deepest = max(len(lut.folders) for lut in luts)
    for depth in range(deepest + 1):
        seen = {lut.folders[-depth:] if depth else () for lut in luts}
        if len(seen) == len(luts):
            return depth
    return deepest


def _file_names(lut: PhotoLut) -> str:
    """A pattern of the photo's name, with any suffix where the LUT's name leaves it out."""
    stem = _literal(lut.stem)
    if lut.photo == lut.stem:
        return stem
    # a.exr is what a.jpg becomes; oiiotool --autocc would encode it again by the photo's rule.
    suffix = r"\.(?!(exr|EXR)$)[A-Za-z0-9]+"
    named_in_full = lut.photo is None and _PHOTO.fullmatch(lut.stem[lut.stem.rfind(".") :])
    return rf"{stem}({suffix})?" if named_in_full else stem + suffix


def _literal(text: str) -> str:
    # `re.escape` also escapes what ECMAScript's expressions forbid to be, such as a space.
    return re.sub(r"([\\^$.|?*+()\[\]{}/])", r"\\\1", text)
