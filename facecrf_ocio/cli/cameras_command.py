"""`facecrf cameras`: responses that were measured, and those that users add."""

from __future__ import annotations

from pathlib import Path

import click

from facecrf_ocio.cli.live import Bar
from facecrf_ocio.cli.options import TEXT_PATH
from facecrf_ocio.cli.sections import Listing
from facecrf_ocio.cli.terminal import DONE, NOTHING, complain, ending_well, one_line, say
from facecrf_ocio.files.plain_text import counted

_METHOD = len("bracket")  # columns: the longest of them


@click.group(cls=Listing, invoke_without_command=True)
@click.pass_context
def cameras(context: click.Context) -> None:
    """List cameras whose response was measured; measure, add, export and merge your own."""
    if context.invoked_subcommand is None:
        context.invoke(list_cameras)


@cameras.command("list")
@click.argument("name", default="")
@ending_well
def list_cameras(name: str) -> int:
    """List those whose make or model has NAME in it: grade, spread in stops, method, proof.

    Each measurement is a line; those of one model follow one another, the surest first.
    """
    from facecrf_ocio.cameras.known_cameras import read_registry, registry_path, shipped_cameras
    from facecrf_ocio.cameras.maker_names import camera_name, maker_of, one_spelling

    own = read_registry(registry_path())
    both = [(one, "ships") for one in shipped_cameras()] + [(one, "yours") for one in own]
    makers = one_spelling(one.make for one, _ in both)
    named = [
        (camera_name(makers[maker_of(one.make)], one.model), one, origin) for one, origin in both
    ]
    found = sorted(
        (
            (called_so, one, origin)
            for called_so, one, origin in named
            if name.casefold() in f"{one.make} {one.model}\n{called_so}".casefold()
        ),
        key=lambda row: (row[0].casefold(), row[2], row[1].grade, row[1].key),
    )
    if not found:
        return complain(
            f"no camera named {name!r} was measured; facecrf cameras lists all", NOTHING
        )
    width = max(len(called_so) for called_so, _, _ in found)
    for called_so, one, origin in found:
        say(
            f"{called_so:<{width}} {one.grade}  {one.spread_stops:.2f} stops  "
            f"{one.method:<{_METHOD}} {origin}  {'; '.join(filter(None, (one.style, one.proof)))}"
        )
    return DONE


@cameras.command()
@click.argument("records", nargs=-1, required=True, type=TEXT_PATH, metavar="RECORD...")
@ending_well
def add(records: tuple[Path, ...]) -> int:
    """Add what facecrf pair, bracket or chart have measured (NAME.crf.json)."""
    from facecrf_ocio.cameras.known_cameras import (
        joined,
        read_registry,
        registry_path,
        write_registry,
    )
    from facecrf_ocio.cameras.maker_names import camera_name
    from facecrf_ocio.record.calibration_record import read_record
    from facecrf_ocio.record.measured import from_record

    new = [from_record(path, read_record(path)) for path in records]
    target = registry_path()
    write_registry(target, joined(read_registry(target), new), overwrite=True)
    for one in new:
        say(f"{camera_name(one.make, one.model)}: added to {target}")
    return DONE


@cameras.command()
@click.argument("paths", nargs=-1, required=True, type=TEXT_PATH, metavar="RAW...")
@ending_well
def measure(paths: tuple[Path, ...]) -> int:
    """Measure cameras by RAW files, or by those below folders, and add them.

    A camera stores a picture of its own in its raw files, by the response of its JPEGs. Of each
    model at most eight files count, and how far apart their curves lie is told. Files that were
    measured before count once.
    """
    from facecrf_ocio.archive.walk import photos_under
    from facecrf_ocio.cameras.known_cameras import (
        read_registry,
        registry_path,
        write_registry,
    )
    from facecrf_ocio.cameras.maker_names import camera_name
    from facecrf_ocio.photo.containers.suffixes import RAW_SUFFIXES
    from facecrf_ocio.record.measured_raws import measure_raws, with_measured

    target = registry_path()
    own = read_registry(target)
    raws = [f"*{suffix}" for suffix in sorted(RAW_SUFFIXES)]
    files: list[Path] = []
    for path in paths:
        files += photos_under(path, raws) if path.is_dir() else [path]
    if not files:
        return complain(f"{paths[0]}: holds no raw files; give a folder with some", NOTHING)
    with Bar() as bar:
        found = measure_raws(files, progress=lambda *told: bar.show(one_line(told[0]), *told[1:]))
    for error in found.passed:
        complain(str(error), NOTHING)
    if not found.cameras:
        return NOTHING
    write_registry(target, with_measured(own, [one for one, _ in found.cameras]), overwrite=True)
    for one, number in found.cameras:
        spread = f", {one.spread_stops:.2f} stops apart" if number > 1 else ""
        name = camera_name(one.make, one.model)
        say(f"{name}: by {counted(number, 'raw file')}{spread}, grade {one.grade}: in {target}")
    return DONE


@cameras.command()
@click.argument("target", type=TEXT_PATH, metavar="FILE")
@click.option("--overwrite", is_flag=True, help="Replace an existing file.")
@ending_well
def export(target: Path, overwrite: bool) -> int:
    """Write your registry to FILE, for others to merge."""
    from facecrf_ocio.cameras.known_cameras import read_registry, registry_path, write_registry

    own = read_registry(registry_path())
    if not own:
        return complain("your registry is empty; add records first", NOTHING)
    write_registry(target, own, overwrite=overwrite)
    say(f"{target}: {counted(len(own), 'camera')}")
    return DONE


@cameras.command("merge")
@click.argument("sources", nargs=-1, required=True, type=TEXT_PATH, metavar="FILE...")
@ending_well
def merge_registries(sources: tuple[Path, ...]) -> int:
    """Take the cameras of exported FILEs into your registry; of the same measurement, theirs."""
    from facecrf_ocio.cameras.known_cameras import (
        joined,
        read_registry,
        registry_path,
        write_registry,
    )
    from facecrf_ocio.errors import LutError

    target = registry_path()
    own = read_registry(target)
    for source in sources:
        if not source.exists():
            raise LutError(f"{source}: does not exist; check the name")
        own = joined(own, read_registry(source))
    write_registry(target, own, overwrite=True)
    say(f"{target}: {counted(len(own), 'camera')}")
    return DONE
