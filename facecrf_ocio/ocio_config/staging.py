"""Files of a config, read back through OpenColorIO before any of them appears."""

from __future__ import annotations

import tempfile
import zipfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.errors import OutputError, SettingsError, reason_of
from facecrf_ocio.files.atomic import Draft, write_files
from facecrf_ocio.lut.ocio_log import unlogged

# The second is no kind of the first, and the third is what the file system says.
REFUSED = (ocio.Exception, ocio.ExceptionMissingFile, RuntimeError)
NEWEST_OF_BLENDER = (2, 4)
"""Profile version that Blender 5.0 reads."""


def profile_version(config: Path) -> tuple[int, int]:
    """Return major and minor version of a config that was written."""
    found = ocio.Config.CreateFromFile(str(config))
    return found.getMajorVersion(), found.getMinorVersion()


def write_staged(
    config: Any, output: Path, folder: str, files: dict[str, bytes], overwrite: bool
) -> tuple[Path, ...]:
    """Write a config and its files, by name, once OpenColorIO has read them back elsewhere.

    Raises
    ------
    SettingsError
        If it is no config that OpenColorIO takes.
    OutputError
        If a file exists and `overwrite` is false, or cannot be written.
    """
    try:
        with tempfile.TemporaryDirectory(prefix="facecrf-") as name, unlogged():
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
        problem = reason_of(error)
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
        if config.getEnvironmentMode() == ocio.ENV_ENVIRONMENT_LOAD_ALL:
            # With this line, which is always written, a config knows none of the variables it knew.
            text = text.replace("environment:\n  {}\n", "", 1)
        plain = stage / "config.ocio"
        plain.write_text(text, encoding="utf-8")
        ocio.Config.CreateFromFile(str(plain)).validate()
        if output.suffix.lower() == ".ocio":
            return text.encode()
        packed = stage / "config.ocioz"
        plain.unlink()
        config.archive(str(packed))
        ocio.Config.CreateFromFile(str(packed)).validate()
        _require_packed(output, packed, files)
        return packed.read_bytes()
    except REFUSED as error:
        problem = str(error).strip().replace("\n", " ")
        raise SettingsError(f"{output}: not a config OpenColorIO takes ({problem})") from error


def _require_packed(output: Path, packed: Path, files: dict[str, bytes]) -> None:
    """Raise SettingsError where OpenColorIO left a LUT out, as it does by suffixes."""
    with zipfile.ZipFile(packed) as archive:
        inside = {Path(name.replace("\\", "/")).name for name in archive.namelist()}
    for name in sorted(files.keys() - inside):
        raise SettingsError(f"{output}: OpenColorIO packs no {name}; give the LUT its suffix")


def _accept(_: Path) -> None:
    """Staged content was read back already."""
