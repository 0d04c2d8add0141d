"""Outputs that are not as they were written, made again from the photos as the batch did."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from facecrf_ocio import __version__
from facecrf_ocio.archive.check_outputs import Fault
from facecrf_ocio.archive.job import Event, Job
from facecrf_ocio.archive.manifest.damage import understanding
from facecrf_ocio.archive.manifest.read_only import Reader, reading
from facecrf_ocio.archive.run import run
from facecrf_ocio.archive.task import FAILED, Recipe
from facecrf_ocio.archive.walk import as_utf8
from facecrf_ocio.files.threads import usable_cores

_BATCH = "run the batch again, which makes it again"


def make_again(folder: Path, faults: Iterable[Fault]) -> list[str]:
    """Make the outputs of the photos again that have a fault; return what went wrong.

    Raises
    ------
    OutputError, PhotoError
        As `run` does; also if the manifest does not tell where the photos are.
    """
    photos = sorted({fault.photo for fault in faults if fault.photo})
    problems: list[str] = []

    def tell(event: Event) -> None:
        if event.result.outcome == FAILED:
            problems.append(f"{as_utf8(event.name)}: {event.result.reason}; {event.result.remedy}")

    with reading(folder) as manifest:
        source = Path(manifest.about("source") or "")
        of_recipe: dict[str, list[str]] = {}
        for name in photos:
            of_recipe.setdefault(manifest.recipe_sha256_of(name), []).append(name)
        recipes = {digest: _recipe(manifest, digest) for digest in of_recipe}
    for digest, names in of_recipe.items():
        recipe = recipes[digest]
        if recipe is None:
            problems += [
                f"{as_utf8(name)}: another version made its outputs; {_BATCH}" for name in names
            ]
        else:
            job = Job(source, folder, recipe, usable_cores(), again=frozenset(names))
            run(job, (source / name for name in names), tell)
    return problems


def _recipe(manifest: Reader, digest: str) -> Recipe | None:
    """How photos of a recipe were treated; None if this version would treat them otherwise."""
    text = manifest.about(f"recipe {digest}")
    if text is None:
        return None
    with understanding(manifest.path):
        recipe = Recipe.from_json(text)
    return recipe if recipe.sha256(__version__) == digest else None
