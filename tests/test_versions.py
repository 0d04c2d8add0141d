"""Versions of what is installed, told by the folders of its distributions where there are any."""

from __future__ import annotations

import sys
import zipfile
from importlib import metadata
from pathlib import Path

import pytest

from facecrf_ocio.files import versions as module
from facecrf_ocio.files.versions import versions


@pytest.fixture
def place(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """An empty folder, which is all that is on `sys.path`."""
    forget()
    monkeypatch.setattr(sys, "path", [str(tmp_path), "/no/such/folder"])
    yield tmp_path
    forget()


def forget() -> None:
    module._folders.cache_clear()
    module._version.cache_clear()


def distribution(folder: Path, version: str, name: str = "x", file: str = "METADATA") -> None:
    folder.mkdir(parents=True)
    (folder / file).write_text(f"Metadata-Version: 2.4\nName: {name}\nVersion: {version}\n\nText\n")


def version_of(name: str, module_name: str = "no_such_module_of_facecrf") -> str:
    forget()
    return module._version(module_name, name)


@pytest.mark.parametrize(
    ("name", "distribution"),
    [
        ("numpy", "numpy"),
        ("scipy", "scipy"),
        ("OpenColorIO", "OpenColorIO"),
        ("OpenImageIO", "openimageio"),
    ],
)
def test_versions_are_those_that_the_standard_library_reads(name: str, distribution: str) -> None:
    assert versions()[name] == metadata.version(distribution)


def test_what_is_not_installed_has_no_version(place: Path) -> None:
    assert not any(version_of(name) for _, name, *_ in module._LIBRARIES.values())


@pytest.mark.parametrize(
    "folder",
    [
        "opencv_python_headless-4.1.dist-info",  # as PEP 503 and wheels write it
        "OpenCV.Python_Headless-4.1.dist-info",  # as older tools did
        "opencv_python_headless.dist-info",  # without its version
    ],
)
def test_names_of_folders_are_read_as_tools_write_them(place: Path, folder: str) -> None:
    distribution(place / folder, "4.1", "opencv-python-headless")
    assert version_of("opencv-python-headless") == "4.1"


def test_a_version_is_what_the_distribution_says_and_not_its_folder(place: Path) -> None:
    distribution(place / "rawpy-0.28.0_local.dist-info", "0.28.0+local")
    assert version_of("rawpy") == "0.28.0+local"


def test_the_first_place_counts(
    place: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = tmp_path_factory.mktemp("other")
    distribution(place / "rawpy-2.dist-info", "2")
    distribution(other / "rawpy-1.dist-info", "1")
    monkeypatch.setattr(sys, "path", [str(place), str(other)])
    assert version_of("rawpy") == "2"
    monkeypatch.setattr(sys, "path", [str(other), str(place)])
    assert version_of("rawpy") == "1"


def test_what_a_broken_upgrade_left_is_passed_over(place: Path) -> None:
    (place / "rawpy-1.dist-info").mkdir()
    (place / "~awpy-1.dist-info").mkdir()
    distribution(place / "rawpy-2.dist-info", "2")
    assert version_of("rawpy") == "2"


def test_where_two_are_said_to_be_in_one_place_the_library_is_asked(place: Path) -> None:
    distribution(place / "stand_in-1.dist-info", "1")
    distribution(place / "stand_in-2.dist-info", "2")
    assert version_of("stand-in") == "1, 2"
    (place / "stand_in_of_facecrf.py").write_text("__version__ = '2'\n")
    assert version_of("stand-in", "stand_in_of_facecrf") == "2"


def test_eggs_and_zips_are_asked_for_where_the_standard_library_finds_them(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    distribution(place / "rawpy-0.9-py3.13.egg-info", "0.9", file="PKG-INFO")
    assert version_of("rawpy") == "0.9"
    packed = place / "packed.zip"
    with zipfile.ZipFile(packed, "w") as file:
        file.writestr("zipped-3.dist-info/METADATA", "Metadata-Version: 2.1\nVersion: 3\n")
    monkeypatch.setattr(sys, "path", [str(packed)])
    assert version_of("zipped") == "3"


def test_a_library_without_a_distribution_is_asked_itself(place: Path) -> None:
    (place / "bare_of_facecrf.py").write_text("__version__ = '7.1'\n")
    (place / "silent_of_facecrf.py").write_text("")
    (place / "broken_of_facecrf.py").write_text("raise OSError('no such library')\n")
    assert version_of("bare", "bare_of_facecrf") == "7.1"
    assert version_of("silent", "silent_of_facecrf") == ""
    assert version_of("broken", "broken_of_facecrf") == ""
