"""The `facecrf` command, run in this process."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from facecrf_ocio.cli.facecrf import main

CODE = "from facecrf_ocio.cli.facecrf import main; main()"


@dataclass(frozen=True)
class Ended:
    """How a run ended."""

    code: int
    out: str
    err: str


@dataclass(frozen=True)
class CommandLine:
    """Runs commands; captures what native libraries print, too."""

    capture: pytest.CaptureFixture[str]

    def __call__(self, *arguments: str | Path) -> Ended:
        self.capture.readouterr()
        with pytest.raises(SystemExit) as ended:
            main.main([str(argument) for argument in arguments], prog_name="facecrf")
        out, err = self.capture.readouterr()
        assert "Traceback" not in err
        code = ended.value.code
        return Ended(code if isinstance(code, int) else 0, out, err)


def write_noise(path: Path, *, seed: int = 0, size: tuple[int, int] = (24, 32)) -> Path:
    """Write a photo in which there is nothing to see."""
    codes = np.random.default_rng(seed).integers(0, 256, (*size, 3), np.uint8)
    Image.fromarray(codes).save(path)
    return path


def names_in(folder: Path) -> set[str]:
    """All names in a folder, hidden ones too; none if it does not exist."""
    return {path.name for path in folder.iterdir()} if folder.exists() else set()
