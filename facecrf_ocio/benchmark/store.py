"""Results on disk, line by line, so that a bench can be interrupted and go on."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, Generic, TypeVar

from facecrf_ocio.errors import OutputError, reason_of

T = TypeVar("T")


class Store(Generic[T]):
    """Results in a JSON Lines file, each under the key of its case.

    Parameters
    ----------
    path
        The file; made with the first result.
    kind
        Dataclass of the results.

    Attributes
    ----------
    results
        Everything in the file, also of other plans.

    Raises
    ------
    OutputError
        If the file cannot be read or written.
    """

    def __init__(self, path: Path, kind: type[T]) -> None:
        self._path = path
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self.results = _load(path, kind)
        except OSError as error:
            raise _refused(path, error) from error

    def append(self, results: Mapping[str, T]) -> None:
        """Add results, on the disk when this returns."""
        lines = [json.dumps({"key": key, **_record(result)}) for key, result in results.items()]
        try:
            with self._path.open("ab") as file:
                file.write("".join(f"{line}\n" for line in lines).encode())
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise _refused(self._path, error) from error
        self.results.update(results)


def _load(path: Path, kind: type[T]) -> dict[str, T]:
    """Read all whole lines, and cut off one that an interruption left unfinished."""
    if not path.exists():
        return {}
    content = path.read_bytes()
    whole = content.rfind(b"\n") + 1
    if whole < len(content):
        os.truncate(path, whole)
    results = {}
    for line in content[:whole].splitlines():
        try:
            record = json.loads(line)
            key = record.pop("key")
            results[key] = kind(**record)
        except (ValueError, KeyError, TypeError, AttributeError):
            continue  # damaged, or of a version with other columns: it is measured again
    return results


def _refused(path: Path, error: OSError) -> OutputError:
    problem = reason_of(error)
    return OutputError(f"{path}: cannot be written: {problem}; choose another folder with -o")


def _record(result: Any) -> dict[str, Any]:
    return asdict(result)
