"""Versions of what is installed, told by the names of its folders."""

from __future__ import annotations

from importlib import metadata

import pytest

from facecrf_ocio.files.versions import versions


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


def test_what_is_not_installed_has_no_version(
    monkeypatch: pytest.MonkeyPatch, tmp_path: object
) -> None:
    from facecrf_ocio.files import versions as module  # noqa: PLC0415

    monkeypatch.setattr("sys.path", [str(tmp_path), "/no/such/folder"])
    module._installed.cache_clear()
    try:
        assert set(versions()) == {"facecrf_ocio", "python"}
    finally:
        module._installed.cache_clear()
