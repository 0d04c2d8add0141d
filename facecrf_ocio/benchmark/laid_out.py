"""Tables as text, for people and for programs, whatever they tell."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence


def number(value: float | None, factor: float, digits: int = 2) -> str:
    """A cell: `factor` times the value, a dash for none."""
    return "-" if value is None else f"{factor * value:.{digits}f}"


def markdown_table(headings: Sequence[str], cells: Sequence[Sequence[str]]) -> str:
    """Lay out a Markdown table whose columns line up, numbers to the right."""
    widths = [max(map(len, column)) for column in zip(headings, *cells, strict=True)]
    lines = [[text.ljust(widths[0]) if i == 0 else text.rjust(widths[i]) for i, text in
              enumerate(line)] for line in (headings, *cells)]  # fmt: skip
    rule = ["-" * widths[0], *("-" * (width - 1) + ":" for width in widths[1:])]
    return "\n".join(f"| {' | '.join(line)} |" for line in (lines[0], rule, *lines[1:]))


def csv_table(records: Sequence[Mapping[str, object]]) -> bytes:
    """Records with the same names, at full precision."""
    return csv_of(list(records[0]) if records else [], records)


def csv_of(names: Sequence[str], records: Iterable[Mapping[str, object]]) -> bytes:
    """Columns of these names, at full precision; what records hold besides is left out."""
    text = io.StringIO()
    writer = csv.DictWriter(text, names, extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(records)
    return text.getvalue().encode()
