"""Files that training reads and writes, known to be there before hours of work, and its errors."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import click

from facecrf_ocio.errors import FaceCRFError, reason_of

IN_FOLDER = click.Path(path_type=Path, file_okay=False, exists=True)
IN_FILE = click.Path(path_type=Path, dir_okay=False, exists=True)
COUNT = click.IntRange(min=1)  # of none, nothing is learned


class OutFile(click.Path):
    """A file to be written, whose folder must be there."""

    def __init__(self) -> None:
        super().__init__(path_type=Path, dir_okay=False)

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """Return the path, or tell that its folder is missing."""
        path = Path(os.fsdecode(super().convert(value, param, ctx)))
        if not path.parent.is_dir():
            self.fail(f"Folder '{path.parent}' does not exist; make it first.", param, ctx)
        return path


class TrainingGroup(click.Group):
    """Commands that tell our errors, the system's, and a missing PyTorch in one line."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command."""
        try:
            return super().invoke(ctx)
        except FaceCRFError as error:
            raise click.ClickException(str(error)) from error
        except OSError as error:
            if error.filename is None:
                raise
            raise click.ClickException(f"{error.filename}: {reason_of(error)}") from error
        except ModuleNotFoundError as error:
            if error.name != "torch":
                raise
            raise click.ClickException("needs PyTorch; pip install -e '.[train]'") from error
