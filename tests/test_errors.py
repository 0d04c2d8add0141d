"""Errors tell themselves the same on the other side of a pool of processes."""

from __future__ import annotations

import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pytest

from facecrf_ocio import calibrate
from facecrf_ocio.errors import ExistsError, FaceCRFError, PhotoError


@pytest.mark.parametrize(
    "error",
    [
        PhotoError(Path("a.jpg"), "is empty", "export it again"),
        PhotoError(None, "has no pixels", "pass some"),
        ExistsError(Path("a.spi1d")),
        ExistsError(Path("a"), "is a folder"),
        FaceCRFError("one line"),
    ],
)
def test_an_error_is_the_same_after_pickling(error: FaceCRFError) -> None:
    again = pickle.loads(pickle.dumps(error))  # noqa: S301 - our own bytes
    assert type(again) is type(error)
    assert str(again) == str(error)
    assert vars(again) == vars(error)


def test_a_pool_of_processes_hands_on_what_is_wrong_with_a_photo(tmp_path: Path) -> None:
    photo = tmp_path / "empty.jpg"
    photo.touch()
    with (
        ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool,
        pytest.raises(PhotoError, match=r"empty\.jpg") as caught,
    ):
        pool.submit(calibrate, photo).result()
    assert isinstance(caught.value, PhotoError)
    assert caught.value.path == photo
