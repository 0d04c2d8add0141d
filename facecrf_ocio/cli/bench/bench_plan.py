"""What `bench` is asked: images, responses, a camera, estimators and their settings."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from facecrf_ocio.cli.bench.bench_terminal import left_out
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.settings import Settings

if TYPE_CHECKING:
    from facecrf_ocio.benchmark.cases import Plan

PROTOCOLS = {"held-out": ("held-out",), "paper": ("paper",), "both": ("held-out", "paper")}
_BOOLEANS = {"true": True, "false": False}


def plan(
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
    """What the options ask for."""
    from facecrf_ocio.benchmark.cases import Plan, choose_estimators
    from facecrf_ocio.benchmark.images import find_linear_images
    from facecrf_ocio.benchmark.responses import read_responses, spread_rows
    from facecrf_ocio.benchmark.virtual_camera import CameraEncoding

    chosen, settings = choose_estimators(estimators), _settings(assignments)
    encoding = CameraEncoding(rest["bits"], rest["jpeg"], rest["noise"])
    responses = read_responses(curves)
    found = find_linear_images(faces, pattern)
    left_out(found.left_out)
    return Plan(
        images=found.images,
        responses=responses,
        rows=spread_rows(len(responses.inverse), every, limit_curves),
        estimators=chosen,
        protocols=PROTOCOLS[rest["protocol"]],
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
