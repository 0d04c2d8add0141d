"""Imports go one way, and the command starts without the heavy libraries."""

from __future__ import annotations

import ast
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import facecrf_ocio

PACKAGE = Path(facecrf_ocio.__file__).parent

# From the bottom up: what stands in one row may import its own row and the rows above it here.
LAYERS = (
    ("values", "settings", "errors", "threads"),
    ("response",),
    ("read", "raw", "profile", "pixels", "integrity"),
    ("face", "skin"),
    ("energy",),
    ("solve",),
    ("cues", "confidence"),
    ("joint",),
    ("calibrate", "together", "pair"),
    ("export", "apply", "lint", "lookup", "lut_file", "exr_header", "image_output"),
    ("report", "benchmark", "linearize", "demo", "synthetic", "ocio_config"),
    ("training", "archive"),
    (
        "cli",
        "cli_config",
        "cli_options",
        "cli_terminal",
        "cli_calibrate",
        "cli_archive",
        "cli_bench",
        "cli_lint",
        "cli_pair",
    ),
)
RANK = {unit: rank for rank, layer in enumerate(LAYERS) for unit in layer}

# `InverseCRF.write`, documented where it stands.
AGAINST_THE_GRAIN = {("values.py", "facecrf_ocio.export")}

WRITERS = {"apply", "exr_header", "image_output", "benchmark"}
HEAVY = {"numpy", "scipy", "cv2", "OpenImageIO", "PyOpenColorIO", "rawpy", "matplotlib", "PIL"}


def imports():
    """(file relative to the package, imported dotted name) of every import, at any depth."""
    for path in sorted(PACKAGE.rglob("*.py")):
        file = path.relative_to(PACKAGE).as_posix()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                yield from ((file, alias.name) for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, f"{file} imports relatively"
                if node.module == "facecrf_ocio":
                    yield from ((file, f"facecrf_ocio.{alias.name}") for alias in node.names)
                else:
                    yield file, node.module


IMPORTS = tuple(imports())


def unit(name):
    """First part below the package: `face/detect.py` and `facecrf_ocio.face.detect` are `face`."""
    return name.removeprefix("facecrf_ocio.").removesuffix(".py").replace("/", ".").split(".")[0]


def own_imports():
    public = {name: unit(home) for name, home in facecrf_ocio._HOME.items()}
    for file, name in IMPORTS:
        if not name.startswith("facecrf_ocio.") or file == "__init__.py":
            continue
        if name != "facecrf_ocio.__version__" and (file, name) not in AGAINST_THE_GRAIN:
            target = unit(name)
            # `from facecrf_ocio import calibrate` may name the function or its module.
            yield file, unit(file), target if target in RANK else public.get(target, target)


def test_every_module_has_its_layer():
    units = {unit(p.relative_to(PACKAGE).as_posix()) for p in PACKAGE.rglob("*.py")}
    assert units - {"__init__"} <= set(RANK)


def test_imports_go_one_way():
    wrong = [
        f"{file} imports {target}"
        for file, source, target in own_imports()
        if RANK[target] > RANK[source]
    ]
    assert wrong == []


def test_no_two_units_import_each_other():
    graph = {name: set() for name in RANK}
    for _, source, target in own_imports():
        if source != target:
            graph[source].add(target)
    assert len(tuple(TopologicalSorter(graph).static_order())) == len(RANK)  # a cycle raises


@pytest.mark.parametrize(
    ("library", "units"),
    [
        ("PyOpenColorIO", {"export", "lut_file", "ocio_config", "benchmark"}),
        ("OpenImageIO", {"read", "raw", "profile", "pixels", "integrity", *WRITERS}),
        ("rawpy", {"raw"}),
        ("matplotlib", {"report", "demo"}),
        ("sklearn", set()),
        ("pytest", set()),
        ("hypothesis", set()),
    ],
)
def test_libraries_stay_where_they_belong(library, units):
    found = {unit(file) for file, name in IMPORTS if name.split(".")[0] == library}
    assert found <= units


def test_the_one_exception_is_still_needed():
    assert set(IMPORTS) >= AGAINST_THE_GRAIN


@pytest.mark.parametrize("module", ["facecrf_ocio", "facecrf_ocio.cli"])
def test_importing_brings_no_heavy_library(module):
    code = f"import sys, {module}; print(*{{m.split('.')[0] for m in sys.modules}})"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert not HEAVY & set(result.stdout.split())


def test_help_brings_no_heavy_library():
    code = (
        "import sys\n"
        "from facecrf_ocio.cli import main\n"
        "sys.argv = ['facecrf', '--help']\n"
        "try:\n    main()\n"
        "except SystemExit as end:\n    assert not end.code\n"
        "print('modules', *{m.split('.')[0] for m in sys.modules})\n"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    modules = set(result.stdout.rpartition("modules ")[2].split())
    assert "facecrf_ocio" in modules
    assert not HEAVY & modules


def test_public_names_are_found_where_they_are_said_to_be():
    for name in facecrf_ocio.__all__:
        assert getattr(facecrf_ocio, name) is not None
    assert set(dir(facecrf_ocio)) == set(facecrf_ocio.__all__)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = facecrf_ocio.nothing


@pytest.mark.parametrize(
    "first", ["import facecrf_ocio.calibrate", "from facecrf_ocio.calibrate import calibrate", ""]
)
def test_calibrate_is_the_function_whichever_way_its_module_came_in(first):
    code = f"{first}\nimport facecrf_ocio\nassert callable(facecrf_ocio.calibrate)"
    subprocess.run([sys.executable, "-c", code], check=True)
