"""What a linter finds, and the tables it looks at."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

ERROR, WARNING = "error", "warning"
CODE_WHITES = (255.0, 1023.0, 4095.0, 65535.0)
"""White of 8, 10, 12 and 16 bits, where a table holds codes and not fractions."""
DECIMAL_COMMA = re.compile(r"\d,\d")
MOST_ENTRIES = 300_000
"""Of a 1-D table: OpenColorIO reads no more from text files, and no curve needs as many."""

Row = tuple[int | None, Sequence[float]]


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing wrong with a LUT file.

    Attributes
    ----------
    path, line
        Where; the line counts from 1 and is None where the format has none.
    severity
        `error`: pixels will be wrong. `warning`: they may be.
    problem, remedy
        What is wrong and what to do, without final periods.
    unusable
        Whether OpenColorIO refuses the file; the problem is then its reason, whole.
    """

    path: Path
    line: int | None
    severity: str
    problem: str
    remedy: str
    unusable: bool = False

    def __str__(self) -> str:
        line = "" if self.line is None else f":{self.line}"
        return f"{self.path}{line}: {self.severity}: {self.problem}; {self.remedy}"


@dataclass(frozen=True, slots=True)
class Table:
    """A one-dimensional table as its file has it.

    Attributes
    ----------
    rows
        Line and numbers of each entry; white is 1.
    promised
        Entries that the header promises, None where it does not say.
    findings
        What was found while reading.
    line
        Where the number of entries is promised.
    step
        By how much two entries differ at least, where they are integers; 0 for floats.
    name
        What to call a table of one column.
    half_domain
        Whether there is an entry for each half float, in the order of their bits.
    of_codes
        Whether its input goes from 0 to 1; scene-linear input goes beyond.
    """

    rows: Sequence[Row]
    promised: int | None = None
    findings: tuple[Finding, ...] = ()
    line: int | None = None
    step: float = 0.0
    name: str = "the curve"
    half_domain: bool = False
    of_codes: bool = True


def broken(path: Path, line: int | None, problem: str, remedy: str) -> Table:
    """A table of which there is nothing to say but one error."""
    return Table([], None, (Finding(path, line, ERROR, problem, remedy),))


def number(word: str) -> float | None:
    """Return the number a word is, NaN and infinities among them; None if it is none."""
    try:
        return None if "_" in word else float(word)
    except ValueError:
        return None


@lru_cache(maxsize=16)  # asked for every row of the one size that a file promises
def count(word: str) -> int | None:
    """Return the number of entries a word promises; None if it is no number, or no LUT's."""
    return int(word) if word.isascii() and word.isdecimal() and len(word) < 10 else None
