"""Imports go one way, and the command starts without the heavy libraries."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections import Counter
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from command_line import write_noise

import facecrf_ocio

PACKAGE = Path(facecrf_ocio.__file__).parent

# From the bottom up: what stands in one row may import its own room and the rows above it here.
LAYERS = (
    ("errors", "estimators", "notebook"),
    ("checks",),
    ("estimates",),
    ("values", "settings"),
    ("files", "color"),
    ("response", "photo"),
    ("face", "lut", "wording"),
    ("published",),
    ("cameras",),
    ("joint", "pair"),
    ("calibrate", "together", "chart"),
    ("image", "record", "synthetic"),
    ("ocio_config", "plots"),
    ("archive", "benchmark", "clip"),
    ("training",),
    ("cli",),
    ("__main__",),
)
RANK = {unit: rank for rank, layer in enumerate(LAYERS) for unit in layer}

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
        if name != "facecrf_ocio.__version__":
            target = unit(name)
            # `from facecrf_ocio import calibrate` may name the function or its module.
            yield file, unit(file), target if target in RANK else public.get(target, target)


def modules():
    return [p.relative_to(PACKAGE) for p in sorted(PACKAGE.rglob("*.py"))]


def test_the_root_holds_few_modules():
    at_root = {p.name for p in modules() if len(p.parts) == 1} - {"__init__.py", "__main__.py"}
    assert len(at_root) <= 8, at_root


def test_no_module_has_the_name_of_another():
    names = Counter(p.stem for p in modules() if p.name not in ("__init__.py", "__main__.py"))
    rooms = {parent.name for p in modules() for parent in p.parents}
    assert [n for n, count in names.items() if count > 1 or n in rooms] == []


def test_modules_do_not_import_in_circles():
    known = {module_name(p) for p in modules()}
    graph = {name: set() for name in known}
    for file, name in IMPORTS:
        source = module_name(Path(file))
        if source != "facecrf_ocio":
            graph[source] |= ({name} & known) - {source, "facecrf_ocio"}
    TopologicalSorter(graph).prepare()  # a cycle raises, and names its modules


def module_name(path):
    return ".".join(("facecrf_ocio", *path.with_suffix("").parts)).removesuffix(".__init__")


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


# Of a room with rooms of its own, in the same order; its modules outside of them come last.
PHOTO = ("raster", "containers", "tags", "decoding")


def test_imports_go_one_way_in_the_room_of_photos():
    def rank(name):
        inside = name.removeprefix("facecrf_ocio.").replace("/", ".").split(".")[1]
        return PHOTO.index(inside) if inside in PHOTO else len(PHOTO)

    inside = [
        (f"{file} imports {name}", rank(file), rank(name))
        for file, name in IMPORTS
        if file.startswith("photo/") and name.startswith("facecrf_ocio.photo.")
    ]
    assert {source for _, source, _ in inside} == set(range(len(PHOTO) + 1))
    assert [text for text, source, target in inside if target > source] == []


def test_no_two_units_import_each_other():
    graph = {name: set() for name in RANK}
    for _, source, target in own_imports():
        if source != target:
            graph[source].add(target)
    assert len(tuple(TopologicalSorter(graph).static_order())) == len(RANK)  # a cycle raises


@pytest.mark.parametrize(
    ("library", "units"),
    [
        ("PyOpenColorIO", {"lut", "image", "ocio_config", "benchmark"}),
        ("OpenImageIO", {"photo", "image", "benchmark", "training", "clip"}),
        ("rawpy", {"photo"}),
        ("matplotlib", {"plots", "benchmark", "cli"}),
        ("sklearn", set()),
        ("pytest", set()),
        ("hypothesis", set()),
    ],
)
def test_libraries_stay_where_they_belong(library, units):
    found = {unit(file) for file, name in IMPORTS if name.split(".")[0] == library}
    assert found <= units


@pytest.mark.parametrize("module", ["facecrf_ocio", "facecrf_ocio.cli.facecrf"])
def test_importing_brings_no_heavy_library(module):
    code = f"import sys, {module}; print(*{{m.split('.')[0] for m in sys.modules}})"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert not HEAVY & set(result.stdout.split())


def test_help_brings_no_heavy_library():
    code = (
        "import sys\n"
        "from facecrf_ocio.cli.facecrf import main\n"
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


def test_the_command_runs_as_a_module():
    command = [sys.executable, "-m", "facecrf_ocio", "--version"]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert told == f"facecrf, version {facecrf_ocio.__version__}\n"


def test_a_calibration_brings_what_it_needs_alone(tmp_path):
    write_noise(tmp_path / "a.png")
    code = (
        "import sys\n"
        "from facecrf_ocio.cli.facecrf import main\n"
        "sys.argv = ['facecrf', 'calibrate', 'a.png', '-o', 'out']\n"
        "try:\n    main()\n"
        "except SystemExit as end:\n    assert end.code == 4\n"  # no face
        "print('modules', *sys.modules)\n"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    modules = set(result.stdout.rpartition("modules ")[2].split())
    assert "cv2" in modules
    slow = {"scipy", "rawpy", "matplotlib", "PIL", "rich"}
    others = {name for name in modules if name.endswith("_command")}
    assert not slow & modules
    assert others == {"facecrf_ocio.cli.calibrate_command"}


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
