"""Feed readers with changed files until a time or a number is up: `python tests/fuzz/fuzz.py -h`.

Every target works in a process of its own. An escape is any exception but our own, a crash, more
than five seconds for one file, or more than a gigabyte of memory. The file of each is kept.
"""

from __future__ import annotations

import argparse
import multiprocessing
import random
import resource
import sys
import tempfile
import traceback
from multiprocessing.sharedctypes import Synchronized
from pathlib import Path
from time import monotonic
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))

from mutate import mutated

LONGEST = 5.0  # [s] of processor time for one file
LARGEST = 1 << 30  # [byte] more than the process had before the first file
NAMES = ("lint", "lut", "icc", "record", "exif", "manifest", "read_photo")
_LOOK = 0.5  # [s]


def work(name: str, folder: str, seed: int, most: int, count: Synchronized[int]) -> None:
    """Feed one target, starting at the given count; the current file stays where it is."""
    from targets import TARGETS  # noqa: PLC0415 - heavy, and not in the parent

    from facecrf_ocio.errors import FaceCRFError  # noqa: PLC0415

    target = TARGETS[name]
    place = Path(folder)
    (place / "seeds").mkdir(exist_ok=True)
    seeds = target.corpus(place / "seeds")
    contents = [path.read_bytes() for path in seeds]
    _limit_memory()
    chance = random.Random(f"{seed} {count.value}")  # noqa: S311
    while count.value < most:
        number = chance.randrange(len(seeds))
        path = place / (target.name or seeds[number].name)
        path.write_bytes(mutated(contents[number], contents, chance))
        (place / "current").write_text(path.name, encoding="utf-8")
        try:
            target.feed(path)
        except FaceCRFError as error:
            str(error).encode()  # what is told can be printed and stored
        count.value += 1


def _limit_memory() -> None:
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    limit = pages * resource.getpagesize() + LARGEST
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


def _processor_seconds(pid: int | None) -> float:
    """[s] A process has worked; a machine with other work must not look like a hang."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace")
    except OSError:
        return 0.0
    user, system = fields.rpartition(")")[2].split()[11:13]
    return (int(user) + int(system)) / 100.0


def fuzz(name: str, seconds: float, most: int, seed: int, keep: Path) -> tuple[int, list[str]]:
    """Feed one target; return the number of executions and the escapes."""
    context = multiprocessing.get_context("spawn")
    count: Any = context.Value("Q", 0)
    escapes: list[str] = []
    end = monotonic() + seconds
    while monotonic() < end and count.value < most:
        with tempfile.TemporaryDirectory(dir=_memory_disk()) as folder:
            errors = Path(folder, "errors")
            arguments = (name, folder, seed, most, count, str(errors))
            process = context.Process(target=_told, args=arguments, daemon=True)
            process.start()
            how = _watch(process, count, end)
            if how:
                escapes.append(_kept(Path(folder), keep, f"{name} {count.value}: {how}", errors))
                count.value += 1
    return count.value, escapes


def _told(*arguments: Any) -> None:
    *rest, errors = arguments
    try:
        work(*rest)
    except BaseException:
        Path(errors).write_text(traceback.format_exc(), encoding="utf-8", errors="replace")
        raise SystemExit(1) from None


def _watch(process: Any, count: Any, end: float) -> str:
    """Wait for a process; what is wrong with how it ended, empty if nothing is."""
    seen, since = -1, 0.0
    while process.is_alive() and monotonic() < end:
        process.join(_LOOK)
        worked = _processor_seconds(process.pid)
        if count.value != seen:
            seen, since = count.value, worked
        elif seen > 0 and worked - since > LONGEST:
            process.kill()
            process.join()
            return f"took more than {LONGEST:g} s"
    if process.is_alive():
        process.kill()
        process.join()
        return ""
    return "" if process.exitcode == 0 else f"exit code {process.exitcode}"


def _kept(folder: Path, keep: Path, what: str, errors: Path) -> str:
    keep.mkdir(parents=True, exist_ok=True)
    named = folder / "current"
    told = errors.read_text(encoding="utf-8") if errors.exists() else ""
    if named.exists():
        path = folder / named.read_text(encoding="utf-8")
        content = path.read_bytes() if path.exists() else b""
        (keep / f"{what.partition(':')[0].replace(' ', '-')}-{path.name}").write_bytes(content)
    return f"{what}\n{told}"


def _memory_disk() -> str | None:
    return "/dev/shm" if Path("/dev/shm").is_dir() else None  # noqa: S108


def main() -> int:
    """Run all targets, or the one that is named, one after the other."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--target", choices=NAMES, help="all by default")
    parser.add_argument("--seconds", type=float, default=600.0, help="for all targets together")
    parser.add_argument("--executions", type=int, default=1 << 62, help="for each target, at most")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, default=Path("fuzz-escapes"), help="for what escapes")
    chosen = parser.parse_args()
    targets = (chosen.target,) if chosen.target else NAMES
    total, escapes = 0, []
    for name in targets:
        share = chosen.seconds / len(targets)
        count, found = fuzz(name, share, chosen.executions, chosen.seed, chosen.keep)
        print(f"{name}: {count} executions, {len(found)} escapes", flush=True)
        total += count
        escapes += found
    print(f"{total} executions, {len(escapes)} escapes")
    print(*escapes, sep="\n", file=sys.stderr)
    return 1 if escapes else 0


if __name__ == "__main__":
    sys.exit(main())
