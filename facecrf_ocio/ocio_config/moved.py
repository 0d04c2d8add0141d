"""Search paths of a config that is extended, and perhaps moves to another folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any


def keep_paths(config: Any, home: Path, target: Path) -> None:
    """Let a config find its files as before, though it gets a search path and may move.

    OpenColorIO looks into a config's own folder only while it has no search path, and takes
    relative ones from there. A path that begins with a variable may be either: both are kept.

    Parameters
    ----------
    config
        To be changed.
    home, target
        Absolute folders it was read from and is written to.
    """
    paths = list(config.getSearchPaths()) or ["."]
    config.clearSearchPaths()
    for path in paths:
        begins_with_variable = path.startswith(("$", "%"))
        if home == target:
            config.addSearchPath(path)
            continue
        config.addSearchPath(str(home / path))
        if begins_with_variable:
            config.addSearchPath(path)
