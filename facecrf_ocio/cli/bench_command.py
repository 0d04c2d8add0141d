"""`facecrf bench`: every estimator on the same photos."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from facecrf_ocio.cli.terminal import (
    DONE,
    FAILED,
    complain,
    ending_well,
    one_line,
    require_writable,
)
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.estimators import ESTIMATOR_NAMES
from facecrf_ocio.settings import PRIORS, Settings

if TYPE_CHECKING:
    from facecrf_ocio.benchmark.cases import Plan
    from facecrf_ocio.benchmark.energy_profiles import Comparison

_PATH = click.Path(path_type=Path)
_PROTOCOLS = {"held-out": ("held-out",), "paper": ("paper",), "both": ("held-out", "paper")}
_REPORTS = 20  # lines of progress where there is no terminal


@click.group()
def bench() -> None:
    """Measure every estimator on the same photos, as the paper's tables do."""


@bench.command()
@click.option(
    "--faces",
    required=True,
    type=_PATH,
    metavar="DIR",
    help="Folder of linear images with faces: EXR, 16-bit TIFF or PNG, camera raw.",
)
@click.option("--pattern", default="*", help="Names to take from it, e.g. 'dev_*_noisy.exr'.")
@click.option(
    "--curves",
    required=True,
    type=_PATH,
    metavar="FILE",
    help="Responses: DoRF's .mat, or an .npz with inverse curves (C, K) or (C, 3, K).",
)
@click.option(
    "--estimators",
    default="all",
    show_default=True,
    metavar="NAMES",
    help=f"all, or a list with commas of {', '.join(ESTIMATOR_NAMES)}.",
)
@click.option("-o", "--output", required=True, type=_PATH, metavar="DIR")
@click.option(
    "--protocol",
    type=click.Choice(list(_PROTOCOLS)),
    default="both",
    show_default=True,
    help="What the prior has seen: not the tested curve's fold, or all DoRF curves.",
)
@click.option("--folds", type=click.IntRange(2), default=5, show_default=True)
@click.option("--bits", type=click.IntRange(8, 16), default=8, show_default=True)
@click.option("--jpeg", type=click.IntRange(1, 100), metavar="QUALITY", help="Store as JPEG.")
@click.option(
    "--noise", type=click.FloatRange(0, min_open=True), metavar="ISO", help="Add a sensor's noise."
)
@click.option("--every", type=click.IntRange(1), default=1, help="Test every n-th curve.")
@click.option("--limit-curves", type=click.IntRange(1), help="Test so many, spread evenly.")
@click.option(
    "--prior",
    type=click.Choice(PRIORS),
    default="auto",
    show_default=True,
    help="What joint is told of the responses' family.",
)
@click.option(
    "--set",
    "assignments",
    multiple=True,
    metavar="NAME=VALUE",
    help="Change one of the estimators' settings; may be repeated.",
)
@click.option(
    "--groups",
    type=(_PATH, str),
    metavar="FILE COLUMN",
    help="Group the images by a column of a tab-separated table of their names.",
)
@click.option("--jobs", type=click.IntRange(1), default=1, show_default=True, help="Processes.")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the noise.")
@ending_well
def synthetic(output: Path, jobs: int, groups: tuple[Path, str] | None, **choices: Any) -> int:
    """Encode linear images with known responses and recover them (Table 1 of the paper).

    Interrupted and started again with the same options and output, it goes on where it was.
    """
    from facecrf_ocio.benchmark.groups import image_groups
    from facecrf_ocio.benchmark.table1 import run_synthetic

    plan = _plan(**choices)
    group_of = image_groups(*groups) if groups else {}
    require_writable(output)
    try:
        with _progress() as progress:
            table = run_synthetic(plan, output, jobs=jobs, progress=progress, groups=group_of)
    except KeyboardInterrupt:
        return complain("interrupted; the same command goes on where it was", FAILED)
    click.echo(f"{table.text}\n{table.timing}")
    for file in table.files:
        click.echo(one_line(str(file)))
    failures = [result for result in table.results if result.outcome == "failed"]
    if not failures:
        return DONE
    return complain(
        f"{len(failures)} of {len(table.results)} estimates broke down, the first was "
        f"{failures[0].estimator} on {failures[0].image}: {failures[0].reason}",
        FAILED,
    )


@bench.command()
@click.option("--faces", required=True, type=_PATH, metavar="DIR", help="Linear images.")
@click.option("--pattern", default="*", help="Names to take from it, e.g. 'dev_*_noisy.exr'.")
@click.option("--curves", required=True, type=_PATH, metavar="FILE", help="Responses.")
@click.option(
    "--kinds", default="all", show_default=True, help="Of the responses, a list with commas."
)
@click.option("--green", is_flag=True, help="Take the green curve for all channels.")
@click.option("--cells", default="all", show_default=True, metavar="NAMES", help="Rows to measure.")
@click.option(
    "--count",
    type=click.IntRange(1),
    default=24,
    show_default=True,
    help="Photos of a cell; three times as many of a day's photos, fewer of large ones.",
)
@click.option("--title", help="Of the table; by default what was measured on.")
@click.option("--jobs", type=click.IntRange(1), default=1, show_default=True, help="Processes.")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True)
@click.option("-o", "--output", required=True, type=_PATH, metavar="DIR")
@ending_well
def stress(
    faces: Path,
    pattern: str,
    curves: Path,
    kinds: str,
    cells: str,
    title: str | None,
    output: Path,
    jobs: int,
    **rest: Any,
) -> int:
    """Send faces through all that photos go through: exposure, color, processing, size, a day.

    Every row of the table is one condition. The headline is `day`: combinations drawn at random.
    Interrupted and started again with the same options and output, it goes on where it was.
    """
    from facecrf_ocio.benchmark.images import find_linear_images
    from facecrf_ocio.benchmark.responses import read_responses
    from facecrf_ocio.benchmark.stress import StressPlan, choose_cells, rows_of_kinds, run_stress

    responses = read_responses(curves)
    rows, chosen = rows_of_kinds(responses, kinds), choose_cells(cells)
    found = find_linear_images(faces, pattern)
    for line in found.left_out:
        click.echo(f"facecrf: left out: {one_line(line)}", err=True)
    which = f"{len(found.images)} images, {len(rows)} responses of {curves.name}"
    plan = StressPlan(title or which, found.images, responses, rows, chosen, **rest)
    require_writable(output)
    try:
        with _progress() as progress:
            return _told(*run_stress(plan, output, jobs=jobs, progress=progress))
    except KeyboardInterrupt:
        return complain("interrupted; the same command goes on where it was", FAILED)


@bench.command()
@click.option("--faces", type=_PATH, metavar="DIR", help="Folder of rendered heads, linear EXR.")
@click.option("--pattern", default="*", help="Names to take from it, e.g. 'dev_*_noisy.exr'.")
@click.option(
    "--maps",
    type=_PATH,
    metavar="DIR",
    help="Their truth: NAME_aux.exr with channels N.*, skin, mel, haem, albedo.*",
)
@click.option("--synthetic", "seeds", type=click.IntRange(0), default=0, help="So many more faces.")
@click.option("--curves", required=True, type=_PATH, metavar="FILE", help="Responses.")
@click.option("--limit-curves", type=click.IntRange(1), help="Test so many, spread evenly.")
@click.option("-o", "--output", required=True, type=_PATH, metavar="DIR")
@ending_well
def ablations(
    faces: Path | None,
    pattern: str,
    maps: Path | None,
    seeds: int,
    curves: Path,
    limit_curves: int | None,
    output: Path,
) -> int:
    """Give steps of the literal method their true answer, one at a time; vary lambda_p.

    Interrupted and started again with the same options and output, it goes on where it was.
    """
    from facecrf_ocio.benchmark.ablations import AblationPlan, run_ablations
    from facecrf_ocio.benchmark.images import find_linear_images
    from facecrf_ocio.benchmark.responses import read_responses, spread_rows
    from facecrf_ocio.benchmark.truth import rendered_head, synthetic_face

    if (faces is None) != (maps is None) or (faces is None and not seeds):
        raise SettingsError("no faces; give --faces with --maps, or --synthetic COUNT")
    responses = read_responses(curves)
    require_writable(output)
    known = []
    if faces is not None and maps is not None:
        for image in find_linear_images(faces, pattern).images:
            stem = image.path.stem.removesuffix("_noisy").removesuffix("_clean")
            known.append(rendered_head(image.path, maps / f"{stem}_aux.exr"))
    known += [synthetic_face(seed) for seed in range(seeds)]
    rows = spread_rows(len(responses.inverse), limit=limit_curves)
    with _progress() as progress:
        text, files = run_ablations(AblationPlan(tuple(known), responses, rows), output, progress)
    return _told(text, files)


@bench.command()
@click.option("--faces", required=True, type=_PATH, metavar="DIR", help="Linear images.")
@click.option("--pattern", default="*", help="Names to take from it.")
@click.option("--curves", required=True, type=_PATH, metavar="FILE", help="Responses.")
@click.option("--limit-curves", type=click.IntRange(1), help="Test so many, spread evenly.")
@click.option("--protocol", type=click.Choice(["held-out", "paper"]), default="held-out")
@click.option("--prior", type=click.Choice(PRIORS), default="auto", show_default=True)
@click.option("-o", "--output", required=True, type=_PATH, metavar="DIR")
@ending_well
def cues(output: Path, **choices: Any) -> int:
    """Leave out each cue of joint, ask each alone, and put the photos of a camera together."""
    from facecrf_ocio.benchmark.cue_shares import run_cues

    unused: dict[str, Any] = {"estimators": "joint", "assignments": (), "every": 1, "folds": 5}
    camera: dict[str, Any] = {"bits": 8, "jpeg": None, "noise": None, "seed": 0}
    plan = _plan(**unused, **camera, **choices)
    require_writable(output)
    output.mkdir(parents=True, exist_ok=True)
    with _progress() as progress:
        text, files = run_cues(plan, output, progress)
    return _told(text, files)


@bench.command()
@click.argument("photos", nargs=-1, required=True, type=_PATH)
@click.option("--half", is_flag=True, help="Take the photos at half their width, to save time.")
@click.option("-o", "--output", type=_PATH, metavar="DIR", help="Also write the table there.")
@ending_well
def consistency(photos: tuple[Path, ...], half: bool, output: Path | None) -> int:
    """Test estimates of PHOTOS without knowing the truth.

    Sent through known curves, a photo's estimate must change as they say; encoded as sRGB, it must
    be sRGB; photos of one camera must agree.
    """
    from facecrf_ocio.benchmark.consistency import (
        consistency_markdown,
        measure_consistency,
        write_consistency,
    )

    if output is not None:
        require_writable(output)
        output.mkdir(parents=True, exist_ok=True)
    with _progress() as progress:
        found = measure_consistency(photos, half=half, progress=progress)
    for line in found.left_out:
        click.echo(f"facecrf: left out: {one_line(line)}", err=True)
    files = () if output is None else write_consistency(found, output)
    return _told(consistency_markdown(found), files)


@bench.command()
@click.argument("source", type=_PATH)
@click.option("--estimators", default="all", show_default=True, metavar="NAMES")
@click.option("-o", "--output", required=True, type=_PATH, metavar="DIR")
@ending_well
def pairs(source: Path, estimators: str, output: Path) -> int:
    """Compare every estimator with real cameras (the paper's Table 2).

    SOURCE is a folder with a.dng and a.jpg (or a.exr and a.png) of the same exposures, or a list of
    two columns, separated by a tab: linear image, encoded image. The truth is what `facecrf pair`
    fits to them. Interrupted and started again, it goes on where it was.
    """
    from facecrf_ocio.benchmark.cases import choose_estimators
    from facecrf_ocio.benchmark.table2 import find_pairs, run_pairs

    chosen = choose_estimators(estimators)
    found = find_pairs(source)
    require_writable(output)
    with _progress() as progress:
        table = run_pairs(found, chosen, output, Settings(), progress)
    return _told(table.text, table.files)


@bench.command()
@click.option("-o", "--output", required=True, type=_PATH, metavar="DIR")
@click.option("--faces", type=_PATH, metavar="DIR", help="Linear images for the curves (Fig. 7).")
@click.option("--pattern", default="*", help="Names to take from it.")
@click.option("--curves", type=_PATH, metavar="FILE", help="Responses to send them through.")
@click.option("--limit-curves", type=click.IntRange(1), default=2, show_default=True)
@click.option("--estimators", default="all", show_default=True, metavar="NAMES")
@ending_well
def figures(
    output: Path,
    faces: Path | None,
    pattern: str,
    curves: Path | None,
    limit_curves: int,
    estimators: str,
) -> int:
    """Draw the paper's figures 2, 3 and 4 on a synthetic face, and 7 on linear images.

    Figure 7 needs --faces and --curves; its photos are encoded with so many of the curves in turn.
    An earlier run's figures are replaced.
    """
    from facecrf_ocio.benchmark.cases import choose_estimators
    from facecrf_ocio.benchmark.energy_profiles import (
        analyzed_example,
        gamma_profile,
        highlight_profile,
    )
    from facecrf_ocio.benchmark.paper_figures import curves_figure, face_figure, png, profile_figure
    from facecrf_ocio.files.atomic import Draft, write_files
    from facecrf_ocio.response.model import dorf_model

    if (faces is None) != (curves is None):
        raise SettingsError("figure 7 needs both --faces and --curves")
    chosen = choose_estimators(estimators)
    require_writable(output)
    model, settings = dorf_model(), Settings()
    drawn = {
        "fig2_gamma.png": profile_figure(
            gamma_profile(model, settings), "camera gamma", "candidate gamma"
        ),
        "fig3_highlights.png": profile_figure(
            highlight_profile(model, settings), "strength of highlights", "candidate gamma"
        ),
        "fig4_skin.png": face_figure(analyzed_example(settings)[1], settings.hue_half_width),
    }
    if faces is not None and curves is not None:
        compared = _comparisons(faces, pattern, curves, limit_curves, chosen)
        drawn["fig7_curves.png"] = curves_figure(compared)
    output.mkdir(parents=True, exist_ok=True)
    drafts = [Draft(output / name, png(figure), lambda _: None) for name, figure in drawn.items()]
    for file in write_files(drafts, overwrite=True):
        click.echo(one_line(str(file)))
    return DONE


def _comparisons(
    faces: Path, pattern: str, curves: Path, limit_curves: int, estimators: tuple[str, ...]
) -> tuple[Comparison, ...]:
    import numpy as np

    from facecrf_ocio.benchmark.energy_profiles import compare
    from facecrf_ocio.benchmark.images import find_linear_images
    from facecrf_ocio.benchmark.responses import read_responses, spread_rows
    from facecrf_ocio.benchmark.virtual_camera import Encoding, take_photo
    from facecrf_ocio.response.model import dorf_model

    responses = read_responses(curves)
    rows = spread_rows(len(responses.inverse), limit=limit_curves)
    compared = []
    for number, image in enumerate(find_linear_images(faces, pattern).images):
        row = rows[number % len(rows)]
        truth = responses.inverse[row]
        photo = take_photo(image.read().encoded, truth, Encoding(), np.random.default_rng(0))
        name = f"{image.path.stem}, {responses.names[row]}"
        compared.append(compare(name, photo, truth, estimators, dorf_model(), Settings()))
    return tuple(compared)


@bench.command()
@click.option("--lut", type=_PATH, metavar="FILE", help="By default the sRGB curve.")
@click.option("--megapixels", type=click.FloatRange(0.01, 150), default=24, show_default=True)
@click.option("--repeat", type=click.IntRange(1), default=5, show_default=True)
@ending_well
def speed(lut: Path | None, megapixels: float, repeat: int) -> int:
    """Time linearization beside OpenColorIO's and OpenImageIO's own calls, and decode + write."""
    import tempfile

    import numpy as np

    from facecrf_ocio.benchmark.speed import measure_speed
    from facecrf_ocio.lut.write import write_lut
    from facecrf_ocio.response.fixed import fixed_curve
    from facecrf_ocio.response.model import CURVE_SIZE, dorf_model, strictly_increasing
    from facecrf_ocio.values import InverseCRF

    with tempfile.TemporaryDirectory(prefix="facecrf-") as folder:
        if lut is None:
            encoded = np.linspace(0.0, 1.0, CURVE_SIZE)
            curve = strictly_increasing([fixed_curve("srgb", encoded, dorf_model())] * 3)
            lut = write_lut(InverseCRF(encoded, curve), Path(folder) / "srgb.spi1d")
        click.echo(measure_speed(lut, megapixels, repeat).text)
    return DONE


@bench.command()
@click.argument("folder", type=_PATH)
@click.option(
    "--photos", type=click.IntRange(8), default=64, show_default=True, help="Use so many."
)
@click.option("--jobs", type=click.IntRange(1), default=2, show_default=True)
@click.option("--repeat", type=click.IntRange(1), default=2, show_default=True)
@ending_well
def archive(folder: Path, photos: int, jobs: int, repeat: int) -> int:
    """Time `batch` on the photos in FOLDER beside calibrating them in a loop, and by more jobs.

    Outputs go to temporary folders.
    """
    from facecrf_ocio.benchmark.archive_cost import measure_archive

    names = sorted(path for path in folder.iterdir() if path.is_file())
    click.echo(measure_archive(names[:photos], jobs, repeat).text)
    return DONE


@bench.command()
@click.argument("folders", nargs=-1, required=True, type=_PATH)
@click.option("-o", "--output", required=True, type=_PATH, metavar="PAGE.md")
@click.option(
    "--findings",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    metavar="FILE",
    help="Markdown before the tables.",
)
@ending_well
def report(folders: tuple[Path, ...], output: Path, findings: Path | None) -> int:
    """Assemble what benches wrote to FOLDERS into one page, its pictures in results/ beside it.

    An earlier page is replaced.
    """
    from facecrf_ocio.benchmark.results_page import results_page
    from facecrf_ocio.files.atomic import Draft, write_files

    text = "" if findings is None else findings.read_text(encoding="utf-8")
    page, pictures = results_page(folders, text, "results")
    require_writable(output.parent)
    beside = output.parent / "results"
    beside.mkdir(parents=True, exist_ok=True)
    contents = {beside / picture.name: picture.read_bytes() for picture in pictures}
    contents[output] = page.encode()
    drafts = [Draft(path, content, lambda _: None) for path, content in contents.items()]
    for file in write_files(drafts, overwrite=True):
        click.echo(one_line(str(file)))
    return DONE


def _told(text: str, files: tuple[Path, ...]) -> int:
    click.echo(text)
    for file in files:
        click.echo(one_line(str(file)))
    return DONE


def _plan(
    *,
    faces: Path,
    pattern: str,
    curves: Path,
    estimators: str,
    assignments: tuple[str, ...],
    every: int,
    limit_curves: int | None,
    **rest: Any,
) -> Plan:
    from facecrf_ocio.benchmark.cases import Plan, choose_estimators
    from facecrf_ocio.benchmark.images import find_linear_images
    from facecrf_ocio.benchmark.responses import read_responses, spread_rows
    from facecrf_ocio.benchmark.virtual_camera import Encoding

    chosen, settings = choose_estimators(estimators), _settings(assignments)
    encoding = Encoding(rest["bits"], rest["jpeg"], rest["noise"])
    responses = read_responses(curves)
    found = find_linear_images(faces, pattern)
    for line in found.left_out:
        click.echo(f"facecrf: left out: {one_line(line)}", err=True)
    return Plan(
        images=found.images,
        responses=responses,
        rows=spread_rows(len(responses.inverse), every, limit_curves),
        estimators=chosen,
        protocols=_PROTOCOLS[rest["protocol"]],
        folds=rest["folds"],
        encoding=encoding,
        settings=settings,
        seed=rest["seed"],
        prior=rest["prior"],
    )


def _settings(assignments: tuple[str, ...]) -> Settings:
    """Settings with some of them changed, each converted to the type of its default."""
    defaults = Settings()
    types: dict[str, type[Any]] = {
        f.name: type(getattr(defaults, f.name)) for f in fields(Settings)
    }
    changed: dict[str, Any] = {}
    for assignment in assignments:
        name, _, text = assignment.partition("=")
        if name not in types:
            raise SettingsError(f"no setting {name!r}; known: {', '.join(types)}")
        try:
            changed[name] = _BOOLEANS[text] if types[name] is bool else types[name](text)
        except (KeyError, ValueError) as error:
            raise SettingsError(
                f"{text!r} is no value of {name}; give {types[name].__name__}"
            ) from error
    return Settings(**changed)


_BOOLEANS = {"true": True, "false": False}


@contextmanager
def _progress() -> Iterator[Callable[[int, int], None]]:
    """A bar on a terminal's stderr, else a line now and then."""
    if not sys.stderr.isatty():
        yield _ProgressLines()
        return
    from rich.console import Console
    from rich.progress import MofNCompleteColumn, Progress, TimeElapsedColumn

    columns = (*Progress.get_default_columns(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task("measuring")
        yield lambda done, total: bar.update(task, completed=done, total=total)


class _ProgressLines:
    """Says so on stderr when another twentieth is done."""

    def __init__(self) -> None:
        self._told = -1

    def __call__(self, done: int, total: int) -> None:
        if done * _REPORTS // total > self._told:
            self._told = done * _REPORTS // total
            click.echo(f"facecrf: {done} of {total} cases are done", err=True)
