"""Small file systems in memory, mounted for a test where the system permits it."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest


class Disk:
    """A file system in memory, whose limits can be changed."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def limit(self, limits: str) -> None:
        self._mount(limits)

    def more(self, limits: str) -> None:
        self._mount(f"remount,{limits}")

    def _mount(self, how: str) -> None:
        command = ["mount", "-t", "tmpfs", "-o", f"{how},mode=777", "none", str(self.folder)]
        try:
            made = subprocess.run(command, check=False, capture_output=True)
        except OSError:
            pytest.skip("there is no mount command here")
        if made.returncode:
            pytest.skip("mounting a small file system is not permitted here")


@contextmanager
def memory_disk(folder: Path) -> Iterator[Disk]:
    """One in a new folder, from its first limit on; gone at the end."""
    folder.mkdir()
    yield Disk(folder)
    if folder.is_mount():
        subprocess.run(["umount", str(folder)], check=True)
