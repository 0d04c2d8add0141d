"""Writing a config of many photos' LUTs, or adding them to another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.color.working_space import (
    WORKING_SPACES,
    working_primaries,
    working_space_matrix,
)
from facecrf_ocio.errors import LutError, OutputError, SettingsError
from facecrf_ocio.files.atomic import require_free
from facecrf_ocio.ocio_config.base import base_config
from facecrf_ocio.ocio_config.description import describe
from facecrf_ocio.ocio_config.entries import Entry, name_luts, safe
from facecrf_ocio.ocio_config.find import PhotoLut, find_luts
from facecrf_ocio.ocio_config.own import REFERENCE, matrix_transform
from facecrf_ocio.ocio_config.staging import write_staged
from facecrf_ocio.values import Primaries

Form = Literal["auto", "spaces", "variable"]

# A config of 1,000 spaces loads in about a second; the time grows faster than the number does.
MOST_SPACES = 500
VARIABLE = "FACECRF_PHOTO"
VARIABLE_SPACE = "facecrf_photo"
DEFAULT_PHOTO = "facecrf_no_photo_named"
_SCENE = ocio.ReferenceSpaceType.REFERENCE_SPACE_SCENE
_DARKENED = 1 / 64  # of the green light of a photo that nobody named: 6 stops, magenta to any eye


def write_config(
    luts: Sequence[Path],
    output: Path,
    *,
    form: Form = "auto",
    merge: str | None = None,
    reference: str | None = None,
    space: str | None = None,
    primaries: Primaries | None = None,
    overwrite: bool = False,
) -> tuple[Path, ...]:
    """Write a config, and copies of the LUTs in the folder `NAME_luts` beside it.

    Parameters
    ----------
    luts
        LUT files, or folders of them; see `find.find_luts`. The records beside them tell the
        photos' names and primaries.
    output
        Named .ocio, or .ocioz for an archive with the LUTs inside.
    form
        `spaces`: a color space and a file rule per photo. `variable`: one color space whose file
        is named by the context variable FACECRF_PHOTO; while it is not set, all is magenta.
        `auto`: `spaces` up to `MOST_SPACES` photos.
    merge
        A config to extend: a file, or `ocio://NAME` of a built-in one.
    reference
        Scene reference of that config, one of `WORKING_SPACES`; None takes it from the role
        `aces_interchange`.
    space
        Working space, one of `WORKING_SPACES`, that the role `scene_linear` shall be; None stands
        for `lin_rec709`. A config to extend keeps its own.
    primaries
        Of all photos; None takes each photo's own where its record tells, else Rec.709.
    overwrite
        Replace existing files.

    Returns
    -------
    tuple of pathlib.Path
        The config, then the LUTs (none for an archive, which holds them).

    Raises
    ------
    LutError
        If a LUT cannot be read.
    SettingsError
        If the config to extend cannot be used; its profile version, which is kept, must be 2 or
        one that the installed OpenColorIO reads.
    OutputError
        If a file exists and `overwrite` is false, or cannot be written.
    """
    output = Path(output)
    if output.suffix.lower() not in (".ocio", ".ocioz"):
        raise OutputError(f"{output}: is not named as a config; give it .ocio or .ocioz")
    require_free(output, overwrite=overwrite)
    base = base_config(merge, space, output)
    taken = (*base.getColorSpaceNames(), VARIABLE_SPACE, DEFAULT_PHOTO)
    entries = name_luts(find_luts(luts), taken)
    folder = f"{safe(output.stem)}_luts"
    base.addSearchPath(folder)
    chain = _chain(base, merge, reference if merge else REFERENCE, primaries)
    files = {entry.file: _content(entry.lut.path) for entry in entries}
    if form == "variable" or (form == "auto" and len(entries) > MOST_SPACES):
        files |= _add_variable(base, entries, chain)
    else:
        _add_spaces(base, entries, chain)
    return write_staged(base, output, folder, files, overwrite)


def _content(lut: Path) -> bytes:
    try:
        return lut.read_bytes()
    except OSError as error:
        raise LutError(f"{lut}: cannot be read ({error.strerror}); check the file") from error


@dataclass(frozen=True, slots=True)
class _Chain:
    """What leads from a LUT's output to the config's reference.

    Attributes
    ----------
    target
        Working space that a matrix leads to.
    rest
        Transforms from there.
    primaries
        Of all photos, if given.
    """

    target: str
    rest: tuple[Any, ...]
    primaries: Primaries | None

    def matrix(self, lut: PhotoLut) -> npt.NDArray[np.float64]:
        """(3, 3) from a LUT's linear RGB to the target."""
        if lut.space:
            return working_space_matrix(working_primaries(lut.space), self.target)
        if lut.leads_to is not None:
            return working_space_matrix(lut.leads_to, self.target)
        if lut.mixes and self.primaries is None:
            raise LutError(
                f"{lut.path}: mixes channels and does not say which RGB it leads to; pass "
                "--primaries, or a LUT that keeps them apart"
            )
        return working_space_matrix(self.primaries or lut.primaries, self.target)

    def steps(self, lut: PhotoLut) -> list[Any]:
        """All transforms that follow a LUT."""
        return [*_unless_identity(self.matrix(lut)), *self.rest]


def _chain(
    config: Any, merge: str | None, reference: str | None, primaries: Primaries | None
) -> _Chain:
    if reference is not None:
        if reference not in WORKING_SPACES:
            raise SettingsError(f"no reference {reference!r}; known: {', '.join(WORKING_SPACES)}")
        return _Chain(reference, (), primaries)
    space = config.getColorSpace("aces_interchange")
    if space is None:
        raise SettingsError(f"{merge}: has no role aces_interchange; pass reference=...")
    if space.isData() or space.getReferenceSpaceType() != _SCENE:
        problem = "has a role aces_interchange that is no scene light"
        raise SettingsError(f"{merge}: {problem}; pass reference=...")
    forward = space.getTransform(ocio.ColorSpaceDirection.COLORSPACE_DIR_TO_REFERENCE)
    backward = space.getTransform(ocio.ColorSpaceDirection.COLORSPACE_DIR_FROM_REFERENCE)
    rest: tuple[Any, ...] = ()
    if forward is not None:
        rest = (forward,)
    elif backward is not None:
        inverse = ocio.TransformDirection.TRANSFORM_DIR_INVERSE
        rest = (ocio.GroupTransform([backward], inverse),)
    return _Chain("aces2065-1", rest, primaries)


def _unless_identity(matrix: Any) -> list[Any]:
    return [] if np.array_equal(matrix, np.eye(3)) else [matrix_transform(matrix)]


def _add_space(
    config: Any,
    name: str,
    files: Sequence[str],
    steps: list[Any],
    description: str,
    between: Any = ocio.Interpolation.INTERP_LINEAR,
) -> None:
    sources = [ocio.FileTransform(src=file, interpolation=between) for file in files]
    space = ocio.ColorSpace(
        name=name, family="facecrf", encoding="sdr-video", description=description
    )
    space.setTransform(
        ocio.GroupTransform([*sources, *steps]),
        ocio.ColorSpaceDirection.COLORSPACE_DIR_TO_REFERENCE,
    )
    if _has_categories(config):  # applications that filter by them would hide it
        space.addCategory("file-io")
    config.addColorSpace(space)


def _has_categories(config: Any) -> bool:
    first = next(iter(config.getColorSpaces()), None)
    return first is not None and any(first.getCategories())


def _add_spaces(config: Any, entries: Sequence[Entry], chain: _Chain) -> None:
    for entry in entries:
        text = describe(entry.lut, chain.primaries)
        between = ocio.INTERP_BEST if entry.lut.mixes else ocio.INTERP_LINEAR  # a 3-D LUT, perhaps
        _add_space(config, entry.name, [entry.file], chain.steps(entry.lut), text, between)
    # Before the config's own rules, of which one for all JPEGs would hide these; and first those
    # that ask for most, since folder/a.jpg is an a.jpg, too.
    rules = config.getFileRules()
    for index, entry in enumerate(sorted(entries, key=lambda entry: -entry.folders)):
        rules.insertRule(index, entry.name, entry.name, entry.pattern)
    config.setFileRules(rules)


def _add_variable(config: Any, entries: Sequence[Entry], chain: _Chain) -> dict[str, bytes]:
    """Add one space for all photos; return the files it needs besides their LUTs."""
    others = {entry.lut.path.suffix.lower() for entry in entries} - {".spi1d"}
    if others:
        raise SettingsError(f"the variable form takes .spi1d only, not {', '.join(sorted(others))}")
    if VARIABLE_SPACE in config.getColorSpaceNames():
        raise SettingsError(f"the config has a color space {VARIABLE_SPACE} already; merge once")
    config.addEnvironmentVar(VARIABLE, DEFAULT_PHOTO.removeprefix("facecrf_"))
    more = {f"{DEFAULT_PHOTO}.spi1d": _magenta_table()}
    # A name that began with the variable could not be archived.
    names = [f"facecrf_${{{VARIABLE}}}.spi1d"]
    matrices = {entry.name: chain.matrix(entry.lut) for entry in entries}
    common = matrices[entries[0].name]
    steps = [*_unless_identity(common), *chain.rest]
    if any(not np.array_equal(matrix, common) for matrix in matrices.values()):
        names.append(f"facecrf_${{{VARIABLE}}}.spimtx")
        matrices[DEFAULT_PHOTO] = working_space_matrix(None, chain.target)
        more |= {f"{name}.spimtx": _spimtx(matrix) for name, matrix in matrices.items()}
        steps = [*chain.rest]
    text = f"The photo that the context variable {VARIABLE} names; magenta while it names none."
    _add_space(config, VARIABLE_SPACE, names, steps, text)
    return more


def _spimtx(matrix: npt.NDArray[np.float64]) -> bytes:
    """A matrix, with offsets of 0, as Sony Pictures Imageworks has it."""
    rows = "".join(f"{r:.17g} {g:.17g} {b:.17g} 0\n" for r, g, b in matrix.tolist())
    return rows.encode()


def _magenta_table() -> bytes:
    """What nobody takes for a photo's light, as .spi1d: sRGB (IEC 61966-2-1) with dark greens.

    A file that is not there would be an error of the whole config to checkers of it, and a plain
    curve would pass for the photo's own. It has an inverse, which checkers ask for.
    """
    linear = decode_srgb(np.linspace(0.0, 1.0, 4096))
    rows = "".join(f"{light:.9g} {light * _DARKENED:.9g} {light:.9g}\n" for light in linear)
    return f"Version 1\nFrom 0 1\nLength 4096\nComponents 3\n{{\n{rows}}}\n".encode()
