"""Train `joint`: `python -m facecrf_ocio.training --help`.

`reproduce` does all of it with the numbers that the shipped weights were made with: `simulate`,
then `fit` for the weights that ship and for those that the bench holds responses out of.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.files.plain_text import counted
from facecrf_ocio.joint.prior import FAMILIES
from facecrf_ocio.training.command_line import (
    COUNT,
    IN_FILE,
    IN_FOLDER,
    OutFile,
    TrainingGroup,
)
from facecrf_ocio.training.parts import read_parts
from facecrf_ocio.training.plan import (
    BAND_PHOTOS,
    BAND_SEED,
    EPOCHS,
    HELD_OUT_MEMBERS,
    MEMBERS,
    PARTS,
    PORTRAITS_SEED,
    SEED,
    WRONG_SEED,
    Data,
    held_out_names,
    left_out,
    makers_left_out,
)
from facecrf_ocio.training.portraits import (
    Versions,
    observe_portraits,
    read_versions,
    write_versions,
)
from facecrf_ocio.training.simulate_parts import simulate_parts
from facecrf_ocio.training.weights import pack, with_band

_FOLDER = click.Path(path_type=Path, file_okay=False)
_OUT_FILE = OutFile()
_DATA = click.option(
    "--data", required=True, type=IN_FOLDER, help="Folder with crf/, faces/rendered/ and scenes/."
)


def _numbers(command: Callable[..., None]) -> Callable[..., None]:
    for option in (
        click.option(
            "--parts", default=PARTS, type=COUNT, show_default=True, help="Of 72 photos each."
        ),
        click.option("--seed", default=SEED, show_default=True),
        click.option("--processes", default=2, type=COUNT, show_default=True),
    ):
        command = option(command)
    return command


@click.group(cls=TrainingGroup)
def main() -> None:
    """Make the weights of the joint estimator."""


@main.command("simulate")
@_DATA
@_numbers
@click.option("-o", "--output", required=True, type=_FOLDER, help="Parts that are there are kept.")
def simulate_command(data: Path, parts: int, seed: int, processes: int, output: Path) -> None:
    """Photograph linear heads through drawn responses and store what is counted in the photos."""
    simulate_parts(Data(data), output, parts, seed, processes)


@main.command("portraits")
@click.argument("folder", type=IN_FOLDER)
@click.option("--seed", default=PORTRAITS_SEED, show_default=True)
@click.option("--processes", default=2, type=COUNT, show_default=True)
@click.option("-o", "--output", required=True, type=_OUT_FILE, help="One that is there is kept.")
def portraits_command(folder: Path, seed: int, processes: int, output: Path) -> None:
    """Send the portraits below FOLDER through known curves and count what their versions show."""
    click.echo(counted(len(_versions(folder, seed, processes, output)), "portrait"))


@main.command("fit")
@_DATA
@click.argument("folder", type=IN_FOLDER)
@click.option(
    "--without",
    type=click.Choice(held_out_names()),
    help="Responses to hold out: a fold of DoRF, or of makers in one of the other files.",
)
@click.option("--portraits", type=IN_FILE, help="Of `portraits`: their versions shall agree.")
@click.option("--parts", default=PARTS, type=COUNT, show_default=True)
@click.option("--epochs", default=EPOCHS, type=COUNT, show_default=True)
@click.option("--members", default=MEMBERS, type=COUNT, show_default=True)
@click.option("-o", "--output", required=True, type=_OUT_FILE)
def fit_command(
    folder: Path, data: Path, without: str | None, portraits: Path | None, **choices: Any
) -> None:
    """Fit prior and networks to the parts that `simulate` stored in FOLDER."""
    from facecrf_ocio.training.fit import Training, fit_joint  # noqa: PLC0415

    source = Data(data)
    paths = sorted(folder.glob("part*.npz"))[: choices["parts"]]
    examples = read_parts(paths, source.curves().kind)
    kept = examples if without is None else examples.where(~left_out(without, examples, source))
    training = Training(epochs=choices["epochs"], members=choices["members"])
    told = {"parts": len(paths), "data_sha256": source.digests()}
    makers = () if without is None else makers_left_out(without, source)
    versions = None if portraits is None else read_versions(portraits)
    fit_joint(choices["output"], kept, training, without, makers, told, versions)


@main.command("charts")
@click.argument("folder", type=IN_FOLDER)
@click.option("--without", multiple=True, metavar="MAKER/MODEL", help="Folders to pass over.")
@click.option("-o", "--output", required=True, type=_OUT_FILE)
def charts_command(folder: Path, without: tuple[str, ...], output: Path) -> None:
    """Measure cameras by photos of a color chart, in FOLDER/MAKER/MODEL."""
    from facecrf_ocio.training.measure_charts import measure_charts, store_charts  # noqa: PLC0415

    found = []
    for one in measure_charts(folder, without):
        click.echo(f"{one.maker} {one.model}: {one.photos} photos, {one.kind}")
        found.append(one)
    if not found:
        raise SettingsError(f"{folder}: no photo in a MAKER/MODEL gives a reliable curve")
    store_charts(found, output)


@main.command("wrong-pictures")
@click.option("--data", type=IN_FOLDER, help="As of `simulate`: learn from rendered heads, too.")
@click.argument("folder", type=IN_FOLDER)
@click.option("--held-out", type=IN_FOLDER, help="Other portraits, to count errors on.")
@click.option("--seed", default=WRONG_SEED, show_default=True)
def wrong_pictures_command(
    folder: Path, data: Path | None, held_out: Path | None, seed: int
) -> None:
    """Learn from portraits below FOLDER what tells inverted, swapped and grainy few-level ones.

    Prints the weights and limits as they stand in `joint/face_parts.py` and `joint/few_levels.py`.
    """
    from facecrf_ocio.training import count_wrong, wrong_pictures  # noqa: PLC0415

    portraits = wrong_pictures.told_by_folder(folder, seed)
    heads = [] if data is None else list(wrong_pictures.told_by_heads(Data(data)))
    found = wrong_pictures.learn(portraits, heads, seed)
    learned = counted(len(portraits), "portrait")
    click.echo(f"{learned}, {counted(len(heads), 'photo')} of rendered heads:\n{found}")
    if held_out is not None:
        others = wrong_pictures.told_by_folder(held_out, seed + 1)
        click.echo(f"{counted(len(others), 'other portrait')}, by these and by those in the code:")
        click.echo(count_wrong.table(others, (found, wrong_pictures.SHIPPED), seed + 1))


@main.command("band")
@_DATA
@click.argument("held_out", type=IN_FILE)
@click.option("--photos", default=BAND_PHOTOS, type=COUNT, show_default=True)
@click.option("--seed", default=BAND_SEED, show_default=True)
@click.option("--write", multiple=True, type=IN_FILE, help="Weights to set the factors in.")
def band_command(
    data: Path, held_out: Path, photos: int, seed: int, write: tuple[Path, ...]
) -> None:
    """Measure the band's factors on the heads `dev_*`, each response by weights without it."""
    _measure_and_set(Data(data), held_out, photos, seed, write)


def _measure_and_set(
    data: Data, held_out: Path, photos: int, seed: int, weights: Sequence[Path]
) -> None:
    from facecrf_ocio.training.band import measure_band  # noqa: PLC0415

    found = measure_band(data, held_out, photos, seed)
    click.echo(
        f"{len(found.of_photos)} photos: 90 % of all codes within {found.band_scale:.3f} of a 90 % "
        "band; errors in stops over expected ones, over codes 64 to 235 and over 16 to 64:"
    )
    for family, (mid, shadows) in zip(FAMILIES, found.stops_scale, strict=True):
        click.echo(f"{family}: {mid:.3f}, {shadows:.3f}")
    command = f"python -m facecrf_ocio.training band --photos {photos} --seed {seed}"
    for path in weights:
        with_band(path, found.band_scale, found.stops_scale, command)


@main.command("reproduce")
@_DATA
@_numbers
@click.option("--portraits", type=IN_FOLDER, help="Photos of faces whose versions shall agree.")
@click.option("--work", type=_FOLDER, default=Path("training"), show_default=True)
@click.option("-o", "--output", required=True, type=_OUT_FILE, help="The weights that ship.")
@click.option("--held-out", type=_OUT_FILE, help="The bench's weights, all in one file.")
@click.option("--epochs", default=EPOCHS, type=COUNT, show_default=True)
@click.option(
    "--members", default=MEMBERS, type=COUNT, show_default=True, help="Of the weights that ship."
)
@click.option(
    "--band-photos",
    default=BAND_PHOTOS,
    type=COUNT,
    show_default=True,
    help="To measure the band with.",
)
def reproduce_command(
    data: Path,
    parts: int,
    seed: int,
    processes: int,
    portraits: Path | None,
    work: Path,
    output: Path,
    held_out: Path | None,
    **choices: int,
) -> None:
    """Simulate, fit and measure everything anew; what WORK holds already is not made again.

    With other numbers than the defaults other weights come out; a small run shows that all works.
    """
    from facecrf_ocio.training.fit import Training, fit_joint  # noqa: PLC0415

    source = Data(data)
    simulate_parts(source, work / "parts", parts, seed, processes)
    paths = sorted((work / "parts").glob("part*.npz"))[:parts]
    examples = read_parts(paths, source.curves().kind)
    told = {"parts": len(paths), "seed": seed, "data_sha256": source.digests()}
    stored = work / "portraits.npz"
    how = PORTRAITS_SEED, processes, stored
    versions = None if portraits is None else _versions(portraits, *how)
    training = Training(epochs=choices["epochs"], members=choices["members"])
    if not output.exists():
        fit_joint(output, examples, training, None, (), told, versions)
    if held_out is None:
        return
    made = {}
    for name in held_out_names():
        made[name] = work / f"without_{name}.npz"
        if not made[name].exists():
            kept = examples.where(~left_out(name, examples, source))
            alone = replace(training, members=HELD_OUT_MEMBERS)
            makers = makers_left_out(name, source)
            fit_joint(made[name], kept, alone, name, makers, told, versions)
    pack(held_out, made)
    _measure_and_set(source, held_out, choices["band_photos"], BAND_SEED, (output, held_out))


def _versions(folder: Path, seed: int, processes: int, stored: Path) -> Versions:
    """Of the portraits below a folder, as they are stored already or made now."""
    if not stored.exists():
        write_versions(stored, observe_portraits(folder, seed, processes))
    return read_versions(stored)


if __name__ == "__main__":
    main()
