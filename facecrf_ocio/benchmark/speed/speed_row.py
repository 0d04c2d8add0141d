"""One line of the table of speed: what was measured, beside the floor and what is wanted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from facecrf_ocio.benchmark.speed.race import Timed


@dataclass(frozen=True, slots=True)
class SpeedRow:
    """What one kind of work costs.

    Attributes
    ----------
    key
        One word, by which a history knows it.
    work
        What is done, against what.
    ours, floor
        What was measured, in words: of this package, and of what nobody can do without.
    value
        The figure that is wanted, in the unit of `wanted`.
    ratio, cpu
        Of ours to the floor, by time (memory, for memory) and by processor time: the less the
        better, whatever `value` is.
    wanted
        What `value` is to be.
    more
        Whether more of it is better.
    """

    key: str
    work: str
    ours: str
    floor: str
    value: float
    ratio: float
    cpu: float
    wanted: float
    more: bool = False

    @property
    def reached(self) -> bool:
        """Whether `value` is what is wanted."""
        return self.value >= self.wanted if self.more else self.value <= self.wanted


def in_ratio(key: str, work: str, ours: Timed, floor: Timed, wanted: float) -> SpeedRow:
    """A row whose value is the ratio of times itself."""
    ratio, cpu = ours.seconds / floor.seconds, ours.cpu / max(floor.cpu, 1e-9)
    told = [f"{1000 * t.seconds:.0f} ms ({1000 * t.cpu:.0f} of CPU)" for t in (ours, floor)]
    return SpeedRow(key, work, told[0], told[1], ratio, ratio, cpu, wanted)


def table_of(rows: Sequence[SpeedRow]) -> str:
    """The table for a terminal."""
    heads = ("work", "this package", "floor", "value", "wanted", "/ floor", "(CPU)", "")
    cells = [heads, *(_cells(row) for row in rows)]
    widths = [max(len(line[k]) for line in cells) for k in range(len(heads))]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if k < 3 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in cells
    )


def _cells(row: SpeedRow) -> tuple[str, ...]:
    bound = f"{'>=' if row.more else '<='} {row.wanted:g}"
    verdict = "reached" if row.reached else "not yet"
    return (
        *(row.work, row.ours, row.floor, f"{row.value:.2f}", bound),
        *(f"{row.ratio:.2f}", f"{row.cpu:.2f}", verdict),
    )
