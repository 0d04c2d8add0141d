"""Whatever a LUT file holds: a finding, an error of ours or a result, and soon."""

from __future__ import annotations

import os
import random
import subprocess
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from file_cost import Meter
from lut_files import CURVE, LOG_TO_INFINITY, MIXES, matrix, write_clf
from mutations import mutated

from facecrf_ocio.errors import LutError
from facecrf_ocio.image.lut_lookup import lut_lookup
from facecrf_ocio.lut import ocio_child
from facecrf_ocio.lut.format_table import FORMATS
from facecrf_ocio.lut.lint import lint
from facecrf_ocio.lut.ocio_processor import RefusedError
from facecrf_ocio.lut.transform import LutTransform
from facecrf_ocio.values import InverseCRF

SEED = int(os.environ.get("FACECRF_SEED", "0"))
COUNT = int(os.environ.get("FACECRF_MUTATIONS", "300"))
SECONDS, MEGABYTES = 2.0, 100.0
GRAY = np.full((1, 2, 3), 0.4, np.float32)


def seeds(folder: Path) -> list[tuple[str, bytes]]:
    """Small whole files of every format, and of what others put into them."""
    codes = np.linspace(0.0, 1.0, 5)
    transform = LutTransform(InverseCRF(codes, np.stack([codes**2] * 3)))
    found = []
    for row in FORMATS.values():
        content = row.write(transform, ("made for damage",))
        content = content.encode() if isinstance(content, str) else content
        found.append((row.suffixes[0], shortened(content)))
    rows = "0 0 0\n0.5 0.5 0.5\n1 1 1\n"
    shapers = "2\n0 1\n0 1\n" * 3
    found += [
        (".spi1d", f"Version 1\nFrom 0 1\nLength 3\nComponents 3\n{{\n{rows}}}\n".encode()),
        (".cube", f"LUT_1D_SIZE 3\nLUT_1D_INPUT_RANGE 0 1\n{rows}".encode()),
        (".cube", f'TITLE "a"\nDOMAIN_MIN 0 0 0\nDOMAIN_MAX 1 1 1\nLUT_1D_SIZE 3\n{rows}'.encode()),
        (".cube", b"LUT_3D_SIZE 2\n" + b"0 0 0\n1 1 1\n" * 4),
        (
            ".csp",
            f"CSPLUTV100\n1D\n\nBEGIN METADATA\na\nEND METADATA\n\n{shapers}\n3\n{rows}".encode(),
        ),
        (".csp", f"CSPLUTV100\n3D\n\n{shapers}\n2 2 2\n{'0 0 0 1 1 1' * 4}".encode()),
        (".clf", write_clf(folder / "a.clf", LOG_TO_INFINITY, matrix(MIXES)).read_bytes()),
        (".clf", write_clf(folder / "a.clf", CURVE, before="a", after="b").read_bytes()),
        (".spimtx", b"1 0 0 0\n0 1 0 0\n0 0 1 0\n"),
        (".3dl", b"0 512 1023\n" + b"0 0 0\n" * 27),
    ]
    return found


def shortened(content: bytes) -> bytes:
    """Without most of 4096 rows, but with as many as are promised; profiles as they are."""
    lines = content.split(b"\n")
    if content[36:40] == b"acsp" or len(lines) < 1000:
        return content
    short = lines[:40] + lines[-40:]
    return b"\n".join(short).replace(b"4096", str(4096 - len(lines) + len(short)).encode())


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/clear_refs").exists(), reason="costs are Linux's to tell")
def test_damaged_files_end_in_findings_errors_or_results(tmp_path: Path) -> None:
    """`FACECRF_MUTATIONS` says how many; the documentation tells of 20,000.

    In a process of its own: what others of this one have taken would be counted as a file's.
    """
    here = Path(__file__).parent
    work = f"import sys; sys.path.insert(0, {str(here)!r}); from test_lut_fuzz import damage; "
    command = [sys.executable, "-c", f"{work}damage({str(tmp_path)!r})"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    print(done.stdout)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[1:] == []


def damage(folder: str) -> None:
    """Print how damaged files end and what they cost at most, then each that costs too much."""
    rng = random.Random(SEED)  # noqa: S311 - damage is no secret
    whole, ends, too_much = seeds(Path(folder)), Counter[str](), []
    meter, costs = Meter(write_clf(Path(folder, "sound.clf"), CURVE)), []
    for number in range(COUNT):
        suffix, content = rng.choice(whole)
        path = Path(folder, f"damaged{suffix}")
        path.write_bytes(mutated(content, rng))
        meter.begin()
        end = lint_end(path)
        ends[end] += 1
        if end != "cannot be used":  # what is, `apply` refuses by the same question
            ends[apply_end(path)] += 1
        cost = meter.end()  # of both processes
        costs.append(cost)
        if cost.seconds > SECONDS or cost.megabytes > MEGABYTES:
            too_much.append((number, suffix, cost))
    print(dict(ends), "at most", *map(max, zip(*costs, strict=True)))
    print(*too_much, sep="\n", end="")


def lint_end(path: Path) -> str:
    found = lint(path)
    unusable = bool(found) and found[-1].unusable
    return "cannot be used" if unusable else "findings" if found else "clean"


def apply_end(path: Path) -> str:
    try:
        found = lut_lookup(path, "linearize").apply(GRAY)
    except LutError:
        return "refused"
    assert np.isfinite(found).all()
    return "applied"


@pytest.mark.parametrize(
    ("given", "told"), [(["", "no table"], "no table"), (["", ""], "it gives no reason")]
)
def test_a_reason_that_is_not_given_is_asked_for_once_more(
    given: list[str], told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(path: Path, *, quiet: bool) -> None:
        raise RefusedError(given.pop(0))

    monkeypatch.setattr(ocio_child, "ocio_processor", refuse)
    assert ocio_child._reason(Path("a.cube")) == told
    assert given == []


def test_a_reason_that_is_no_utf8_is_told_whole_and_hangs_nothing(tmp_path: Path) -> None:
    path = tmp_path / "a.cube"
    path.write_bytes(b"LUT_1D_SIZE \xff\xfe\n0 0 0\n1 1 1\n")
    (found,) = (finding for finding in lint(path) if finding.unusable)
    assert "a.cube' could not be loaded" in found.problem
