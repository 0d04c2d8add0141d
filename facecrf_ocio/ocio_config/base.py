"""The config that photos' LUTs are added to."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.files.folders import real_path
from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.lut.ocio_log import unlogged
from facecrf_ocio.ocio_config.moved import keep_paths
from facecrf_ocio.ocio_config.own import REFERENCE, own_config
from facecrf_ocio.ocio_config.staging import REFUSED

_UPGRADE = (
    "in Python, config = PyOpenColorIO.Config.CreateFromFile(NAME), then "
    "config.upgradeToLatestVersion() and config.serialize() give one of version 2; merge that"
)


def base_config(merge: str | None, space: str | None, output: Path) -> Any:
    """The config of that name, ready to be written to `output`, or one of our own.

    Raises
    ------
    SettingsError
        If it cannot be extended, or has a working space of its own and another is asked for.
    """
    if merge is None:
        return own_config(space or REFERENCE)
    if space is not None:
        raise SettingsError(f'{merge}: has a working space of its own; leave out space="{space}"')
    if not merge.startswith("ocio://") and output.suffix.lower() == ".ocioz":
        raise SettingsError(f"{merge}: files it refers to cannot be packed; write a .ocio instead")
    if merge.lower().endswith(".ocioz") or _is_zip(merge):
        raise SettingsError(f"{merge}: is packed; unpack it (ocioarchive --extract) and name that")
    config = _config_at(merge)
    if config.getMajorVersion() < 2:
        raise SettingsError(f"{merge}: has profile version 1; {_UPGRADE}")
    if not merge.startswith("ocio://"):
        keep_paths(config, real_path(Path(merge)).parent, real_path(output).parent)
    _require_sound(config, merge)
    return config


def _is_zip(merge: str) -> bool:
    """Whether a config is packed, whatever its name: OpenColorIO would read it without its LUTs."""
    try:
        return zipfile.is_zipfile(merge)
    except OSError:  # a folder, or nothing
        return False


def _config_at(merge: str) -> Any:
    try:
        with unlogged():
            config = ocio.Config.CreateFromFile(merge)
    except (*REFUSED, UnicodeDecodeError) as error:  # which may quote what is no text
        problem = plain_text(error, lines=True).partition("\n")[0]
        raise SettingsError(f"{merge}: not a config ({problem}); check the name") from error
    try:
        config.serialize()
    except UnicodeDecodeError as error:
        raise SettingsError(f"{merge}: has texts that are not UTF-8; save it as UTF-8") from error
    return config


def _require_sound(config: Any, merge: str) -> None:
    """Raise SettingsError for a flaw that the merged config would have as well."""
    try:
        with unlogged():
            config.validate()
    except REFUSED as error:
        problem = " ".join(str(error).split()).rstrip(".")
        raise SettingsError(f"{merge}: has a flaw ({problem}); mend it first") from error
