"""The house: small functions, short files, and a unit and a reason beside every number."""

from __future__ import annotations

import ast
import io
import re
import statistics
import subprocess
import zipfile
from collections import Counter
from pathlib import Path

import pytest

import facecrf_ocio

PACKAGE = Path(facecrf_ocio.__file__).parent
FILES = {p.relative_to(PACKAGE).as_posix(): p for p in sorted(PACKAGE.rglob("*.py"))}
SOURCES = {name: path.read_text(encoding="utf-8") for name, path in FILES.items()}
TREES = {name: ast.parse(text) for name, text in SOURCES.items()}

LONGEST_FILE = 300
LONGEST_FUNCTION = 60
MEDIAN_FUNCTION = 8
LARGEST_WHEEL = 5_000_000  # bytes
# What a built wheel of 486 files holds beside them is 32,022 bytes: a digest of each, two licenses.
METADATA = 9_384  # bytes
DIGEST = 46.6  # bytes a file

# `TOP = 5`, `_SIZES: tuple[int, ...] = (3, 4)`; a name in capitals is a constant by PEP 8.
CONSTANT = re.compile(r"_?[A-Z][A-Z0-9_]*$")


def functions():
    """(where, lines of the body without its docstring) of every function and method."""
    for name, tree in TREES.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                body = node.body[1:] if ast.get_docstring(node) is not None else node.body
                lines = body[-1].end_lineno - body[0].lineno + 1 if body else 0
                yield f"{name}:{node.name}", lines


def has_number(node):
    """Whether a constant's value is spelled with a number; an index is none."""
    if isinstance(node, ast.Subscript):
        return has_number(node.value)
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float) and not isinstance(node.value, bool)
    return any(has_number(part) for part in ast.iter_child_nodes(node))


def constants(name):
    """(name, first line, last line) of a module's and its classes' constants with numbers."""
    for holder in ast.walk(TREES[name]):
        if not isinstance(holder, ast.Module | ast.ClassDef) or is_enumeration(holder):
            continue
        for node, after in zip(holder.body, [*holder.body[1:], None], strict=True):
            targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", 0)]
            names = [t.id for t in flat(targets) if isinstance(t, ast.Name)]
            if (
                isinstance(node, ast.Assign | ast.AnnAssign)
                and node.value is not None
                and any(CONSTANT.match(n) for n in names)
                and has_number(node.value)
            ):
                said = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
                yield ", ".join(names), node.lineno, node.end_lineno, said


def is_enumeration(holder):
    return any(ast.unparse(base).endswith("Enum") for base in getattr(holder, "bases", ()))


def flat(targets):
    for target in targets:
        yield from flat(target.elts) if isinstance(target, ast.Tuple) else [target]


def unexplained(name):
    """Constants without a docstring, nor a comment on their lines or in the lines above them."""
    lines = SOURCES[name].splitlines()
    for constant, first, last, documented in constants(name):
        commented = any("#" in line for line in lines[first - 1 : last])
        if not (documented or commented or lines[first - 2].lstrip().startswith("#")):
            yield f"{name}:{first} {constant}"


def test_files_are_short():
    long = [name for name, text in SOURCES.items() if text.count("\n") >= LONGEST_FILE]
    assert long == [], "split them by idea"


def test_functions_are_small():
    lengths = dict(functions())
    assert statistics.median(lengths.values()) <= MEDIAN_FUNCTION
    assert {f: n for f, n in lengths.items() if n > LONGEST_FUNCTION} == {}


@pytest.mark.parametrize("name", FILES)
def test_every_number_has_its_reason_beside_it(name):
    assert list(unexplained(name)) == []


def test_no_public_class_has_the_name_of_another():
    names = Counter(
        node.name
        for tree in TREES.values()
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
    )
    assert [name for name, count in names.items() if count > 1] == []


SQL = re.compile(r"\b(SELECT .* FROM|INSERT INTO|UPDATE \w+ SET|DELETE FROM|CREATE TABLE|PRAGMA)\b")


def test_sql_stands_in_one_room():
    speaking = {
        name
        for name, tree in TREES.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and SQL.search(node.value)
    }
    assert {Path(name).parent.as_posix() for name in speaking} == {"archive/manifest"}


def test_nothing_speaks_to_sqlite_but_that_room():
    using = {
        name
        for name, tree in TREES.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.Import) and any(alias.name == "sqlite3" for alias in node.names)
    }
    assert {Path(name).parent.as_posix() for name in using} == {"archive/manifest"}


def test_what_ships_is_under_5_mb():
    """As a wheel holds it: a .zip by deflate."""
    packed = io.BytesIO()
    digests = 0.0
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path in sorted(PACKAGE.rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts:
                wheel.write(path, path.relative_to(PACKAGE.parent).as_posix())
                digests += DIGEST
    assert packed.tell() + METADATA + digests < LARGEST_WHEEL


def test_nothing_lies_at_the_top_that_a_download_or_build_left():
    root = PACKAGE.parent
    if not (root / ".git").exists():
        pytest.skip("the package is installed apart from the project")
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=root, check=True, capture_output=True, text=True
    ).stdout
    top = {Path(name).parts[0] for name in listed.split("\0") if name}
    folders = {".ci", "docs", "examples", "facecrf_ocio", "luts", "nodes", "tests"}
    texts = {"CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md", "LICENSE", "README.md"}
    assert top == folders | texts | {"SECURITY.md", "pyproject.toml", ".gitignore"}


def test_the_citation_names_this_version():
    citation = PACKAGE.parent / "CITATION.cff"
    if not citation.is_file():
        pytest.skip("the package is installed apart from the project")
    assert f"version: {facecrf_ocio.__version__}\n" in citation.read_text(encoding="utf-8")
