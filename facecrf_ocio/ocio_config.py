"""OpenColorIO configs that hold the curves of many photos."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.errors import LutError, OutputError, SettingsError
from facecrf_ocio.export.atomic import Draft, require_free, write_files
from facecrf_ocio.export.working_space import WORKING_SPACES, working_space_matrix
from facecrf_ocio.lut_file import lut_processor
from facecrf_ocio.values import Primaries

Form = Literal["auto", "spaces", "variable"]

# A config of 1,000 spaces loads in about a second; the time grows faster than the number does.
MOST_SPACES = 500
VARIABLE = "FACECRF_PHOTO"
VARIABLE_SPACE = "facecrf_photo"
DEFAULT_PHOTO = "facecrf_default_srgb"
_SUFFIXES = (".spi1d", ".cube", ".clf", ".ctf", ".csp")
_NEWEST_PROFILE = (2, 4)  # Blender 5.0 reads none newer


@dataclass(frozen=True, slots=True)
class Entry:
    """One LUT of a config: its file, its name in the config, and the photos it is for."""

    lut: Path
    name: str
    pattern: str


def write_config(
    luts: Sequence[Path],
    output: Path,
    *,
    form: Form = "auto",
    merge: str | None = None,
    reference: str | None = None,
    primaries: Primaries | None = None,
    overwrite: bool = False,
) -> tuple[Path, ...]:
    """Write a config, and copies of the LUTs in the folder `NAME_luts` beside it.

    Parameters
    ----------
    luts
        LUT files, or folders of them (of a photo's several formats the first of .spi1d, .cube,
        .clf, .ctf, .csp counts).
    output
        Named .ocio, or .ocioz for an archive with the LUTs inside.
    form
        `spaces`: a color space and a file rule per photo. `variable`: one color space whose file
        is named by the context variable FACECRF_PHOTO, sRGB's curve while it is not set.
        `auto`: `spaces` up to `MOST_SPACES` photos.
    merge
        A config to extend: a file, or `ocio://NAME` of a built-in one.
    reference
        Scene reference of that config, one of `WORKING_SPACES`; None takes it from the role
        `aces_interchange`. Without `merge`, `lin_rec709` is meant.
    primaries
        Of the photos; None stands for Rec.709.
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
        If the config to extend cannot be used.
    OutputError
        If a file exists and `overwrite` is false, or cannot be written.
    """
    output = Path(output)
    if output.suffix.lower() not in (".ocio", ".ocioz"):
        raise OutputError(f"{output}: is not named as a config; give it .ocio or .ocioz")
    require_free(output, overwrite=overwrite)
    base = _base(merge, output)
    entries = name_luts(find_luts(luts), taken=tuple(base.getColorSpaceNames()))
    folder = f"{_safe(output.stem)}_luts"
    base.addSearchPath(folder)
    to_reference = _to_reference(base, reference if merge else "lin_rec709", primaries)
    files = {f"{entry.name}{entry.lut.suffix.lower()}": _content(entry.lut) for entry in entries}
    if form == "variable" or (form == "auto" and len(entries) > MOST_SPACES):
        files[f"{DEFAULT_PHOTO}.spi1d"] = _srgb_table()
        _add_variable(base, entries, to_reference)
    else:
        _add_spaces(base, entries, to_reference)
    return _write(base, output, folder, files, overwrite)


def find_luts(paths: Sequence[Path]) -> tuple[Path, ...]:
    """LUT files among files and folders; LutError if one is missing or none is left."""
    found: dict[Path, None] = {}
    for path in map(Path, paths):
        if path.is_dir():
            best: dict[Path, Path] = {}
            for suffix in reversed(_SUFFIXES):
                best |= {
                    lut.with_suffix(""): lut
                    for lut in path.rglob("*")
                    if lut.suffix.lower() == suffix and lut.is_file()
                }
            found |= dict.fromkeys(best[stem] for stem in sorted(best))
        else:
            found[path] = None
    if not found:
        raise LutError(f"{', '.join(map(str, paths))}: no LUT; name a LUT or a folder of them")
    for lut in found:
        lut_processor(lut)
    return tuple(found)


def name_luts(luts: Sequence[Path], *, taken: Sequence[str] = ()) -> tuple[Entry, ...]:
    """Give each LUT a name OpenColorIO takes, and a pattern (regular expression) of its photos.

    Photos of one name in several folders are told apart by their folder's name, as that of the
    LUT.
    """
    stems = [lut.stem for lut in luts]
    used = {name.casefold() for name in taken} | {VARIABLE_SPACE, DEFAULT_PHOTO}
    entries = []
    for lut in luts:
        shared = stems.count(lut.stem) > 1
        parent = lut.resolve().parent.name
        wanted = "facecrf_" + _safe(f"{parent}_{lut.stem}" if shared else lut.stem)
        name, number = wanted, 2
        while name.casefold() in used:
            name, number = f"{wanted}_{number}", number + 1
        used.add(name.casefold())
        folder = _literal(parent) + r"[/\\]" if shared else ""
        pattern = rf"(.*[/\\])?{folder}{_literal(lut.stem)}\.[A-Za-z0-9]+"
        entries.append(Entry(lut, name, pattern))
    return tuple(entries)


def _safe(text: str) -> str:
    """Without what OpenColorIO, shells or file systems give a meaning; letters of any script."""
    return re.sub(r"[^\w.-]", "_", text)[:60]


def _literal(text: str) -> str:
    # `re.escape` also escapes what ECMAScript's expressions forbid to be, such as a space.
    return re.sub(r"([\\^$.|?*+()\[\]{}/])", r"\\\1", text)


def _content(lut: Path) -> bytes:
    try:
        return lut.read_bytes()
    except OSError as error:
        raise LutError(f"{lut}: cannot be read ({error.strerror}); check the file") from error


def _base(merge: str | None, output: Path) -> Any:
    if merge is None:
        return _own_config()
    if not merge.startswith("ocio://") and output.suffix.lower() == ".ocioz":
        raise SettingsError(f"{merge}: files it refers to cannot be packed; write a .ocio instead")
    try:
        config = ocio.Config.CreateFromFile(merge)
    except ocio.Exception as error:
        problem = str(error).strip().partition("\n")[0]
        raise SettingsError(f"{merge}: not a config ({problem}); check the name") from error
    version = (config.getMajorVersion(), config.getMinorVersion())
    if not (2, 0) <= version <= _NEWEST_PROFILE:
        raise SettingsError(
            f"{merge}: has profile version {version[0]}.{version[1]}; use one of 2.0 to 2.4"
        )
    if not merge.startswith("ocio://"):
        _keep_paths(config, Path(merge).resolve().parent, output.resolve().parent)
    return config


def _keep_paths(config: Any, home: Path, target: Path) -> None:
    """Let a config's relative search paths mean what they did when it moves to another folder."""
    if home == target:
        return
    paths = list(config.getSearchPaths()) or [""]
    config.clearSearchPaths()
    for path in paths:
        variable = path.startswith(("$", "%"))
        config.addSearchPath(path if variable else str(home / path))


def _own_config() -> Any:
    config = ocio.Config()
    config.setVersion(2, 1)
    config.setDescription("Curves from code values to scene-linear light, made by facecrf.")
    curve = ocio.ExponentWithLinearTransform(
        gamma=[2.4, 2.4, 2.4, 1.0],
        offset=[0.055, 0.055, 0.055, 0.0],
        direction=ocio.TransformDirection.TRANSFORM_DIR_INVERSE,
    )
    aces = _matrix(np.linalg.inv(working_space_matrix(None, "aces2065-1")))
    config.addColorSpace(ocio.ColorSpace(name="lin_rec709", encoding="scene-linear"))
    config.addColorSpace(
        ocio.ColorSpace(name="ACES2065-1", encoding="scene-linear", toReference=aces)
    )
    config.addColorSpace(ocio.ColorSpace(name="srgb", encoding="sdr-video", fromReference=curve))
    config.addColorSpace(ocio.ColorSpace(name="raw", isData=True, encoding="data"))
    for role, space in {
        "default": "raw",
        "data": "raw",
        "reference": "lin_rec709",
        "scene_linear": "lin_rec709",
        "aces_interchange": "ACES2065-1",
        "color_picking": "srgb",
        "texture_paint": "srgb",
        "color_timing": "srgb",
        "compositing_log": "srgb",
        "matte_paint": "srgb",
    }.items():
        config.setRole(role, space)
    config.addDisplayView("sRGB", "sRGB", "srgb")
    config.addDisplayView("sRGB", "Raw", "raw")
    config.setActiveDisplays("sRGB")
    config.setActiveViews("sRGB, Raw")
    return config


def _to_reference(config: Any, reference: str | None, primaries: Primaries | None) -> list[Any]:
    """What leads from the photo's linear RGB to the config's reference."""
    if reference is not None:
        if reference not in WORKING_SPACES:
            raise SettingsError(f"no reference {reference!r}; known: {', '.join(WORKING_SPACES)}")
        return _unless_identity(working_space_matrix(primaries, reference))
    space = config.getColorSpace("aces_interchange")
    if space is None:
        raise SettingsError("the config has no role aces_interchange; pass --reference")
    steps = _unless_identity(working_space_matrix(primaries, "aces2065-1"))
    forward = space.getTransform(ocio.ColorSpaceDirection.COLORSPACE_DIR_TO_REFERENCE)
    backward = space.getTransform(ocio.ColorSpaceDirection.COLORSPACE_DIR_FROM_REFERENCE)
    if forward is not None:
        return [*steps, forward]
    if backward is not None:
        inverse = ocio.TransformDirection.TRANSFORM_DIR_INVERSE
        return [*steps, ocio.GroupTransform([backward], inverse)]
    return steps


def _unless_identity(matrix: Any) -> list[Any]:
    return [] if np.array_equal(matrix, np.eye(3)) else [_matrix(matrix)]


def _matrix(matrix: Any) -> Any:
    full = np.eye(4)
    full[:3, :3] = matrix
    return ocio.MatrixTransform(matrix=full.ravel().tolist())


def _space(name: str, source: str, steps: list[Any], description: str) -> Any:
    file = ocio.FileTransform(src=source, interpolation=ocio.Interpolation.INTERP_LINEAR)
    space = ocio.ColorSpace(
        name=name, family="facecrf", encoding="sdr-video", description=description
    )
    space.setTransform(
        ocio.GroupTransform([file, *steps]), ocio.ColorSpaceDirection.COLORSPACE_DIR_TO_REFERENCE
    )
    return space


def _add_spaces(config: Any, entries: Sequence[Entry], steps: list[Any]) -> None:
    rules = config.getFileRules()
    for index, entry in enumerate(entries):
        source = f"{entry.name}{entry.lut.suffix.lower()}"
        config.addColorSpace(_space(entry.name, source, steps, "One photo, by its own curve."))
        # Before the config's own rules, of which one for all JPEGs would hide these.
        rules.insertRule(index, entry.name, entry.name, entry.pattern)
    config.setFileRules(rules)


def _add_variable(config: Any, entries: Sequence[Entry], steps: list[Any]) -> None:
    others = {entry.lut.suffix.lower() for entry in entries} - {".spi1d"}
    if others:
        raise SettingsError(f"the variable form takes .spi1d only, not {', '.join(sorted(others))}")
    if VARIABLE_SPACE in config.getColorSpaceNames():
        raise SettingsError(f"the config has a color space {VARIABLE_SPACE} already; merge once")
    config.addEnvironmentVar(VARIABLE, DEFAULT_PHOTO.removeprefix("facecrf_"))
    # A name that began with the variable could not be archived.
    text = f"The photo whose LUT the context variable {VARIABLE} names; sRGB while it is not set."
    config.addColorSpace(_space(VARIABLE_SPACE, f"facecrf_${{{VARIABLE}}}.spi1d", steps, text))


def _srgb_table() -> bytes:
    """Curve of sRGB (IEC 61966-2-1) as .spi1d."""
    codes = np.linspace(0.0, 1.0, 4096)
    light = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    rows = "".join(f"{value:.9g}\n" for value in light)
    return f"Version 1\nFrom 0 1\nLength 4096\nComponents 1\n{{\n{rows}}}\n".encode()


def _write(
    config: Any, output: Path, folder: str, files: dict[str, bytes], overwrite: bool
) -> tuple[Path, ...]:
    try:
        with tempfile.TemporaryDirectory(prefix="facecrf-") as name:
            content = _staged(config, Path(name), output, folder, files)
    except OSError as error:
        raise OutputError(f"{output}: no room to prepare it ({error.strerror})") from error
    drafts = [Draft(output, content, _accept)]
    if output.suffix.lower() == ".ocioz":
        return write_files(drafts, overwrite=overwrite)
    luts = output.parent / folder
    created = not luts.exists()
    try:
        luts.mkdir(exist_ok=True)
        drafts += [Draft(luts / name, data, _accept) for name, data in files.items()]
        return write_files(drafts, overwrite=overwrite)
    except OSError as error:
        problem = (error.strerror or str(error)).lower()
        raise OutputError(f"{luts}: cannot be written: {problem}; choose another folder") from error
    finally:
        if created:
            with suppress(OSError):  # keeps a folder with files
                luts.rmdir()


def _staged(config: Any, stage: Path, output: Path, folder: str, files: dict[str, bytes]) -> bytes:
    """The output's bytes, once OpenColorIO has read it back with its LUTs beside it."""
    (stage / folder).mkdir()
    for name, data in files.items():
        (stage / folder / name).write_bytes(data)
    try:
        config.setWorkingDir(str(stage))
        config.validate()
        text: str = config.serialize()
        plain = stage / "config.ocio"
        plain.write_text(text, encoding="utf-8")
        ocio.Config.CreateFromFile(str(plain)).validate()
        if output.suffix.lower() == ".ocio":
            return text.encode()
        packed = stage / "config.ocioz"
        plain.unlink()
        config.archive(str(packed))
        ocio.Config.CreateFromFile(str(packed)).validate()
        return packed.read_bytes()
    except ocio.Exception as error:
        problem = str(error).strip().replace("\n", " ")
        raise SettingsError(f"{output}: not a config OpenColorIO takes ({problem})") from error


def _accept(_: Path) -> None:
    """Staged content was read back already."""
