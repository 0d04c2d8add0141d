"""Text of unknown encoding becomes text that can be stored and shown."""

from __future__ import annotations

import json
import sqlite3
import unicodedata
from pathlib import Path

import cv2
import numpy as np
import pytest
import rawpy
from hypothesis import given
from hypothesis import strategies as st
from photo_files import app1, exif_of, with_segments

from facecrf_ocio import read_photo
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.plain_text import LONGEST, complaint, plain_text
from facecrf_ocio.image.apply import write_exr

ANYTHING = st.one_of(
    st.binary(), st.text(st.characters(exclude_categories=())), st.text().map(ValueError)
)


@pytest.mark.parametrize(
    ("said", "text"),
    [
        ("Canon", "Canon"),
        (b"Canon\0\0", "Canon"),
        ("Caf\udce9 Kamera", "Café Kamera"),  # Latin-1, as OpenImageIO's bindings give it
        ("Caf\udcc3\udca9", "Café"),  # UTF-8 byte by byte
        ("写真機", "写真機"),
        (b"\x93quoted\x94", "“quoted”"),  # Windows-1252
        (b"\x81\xe9", "é"),  # no character there either
        ("lone \ud800 half", "lone � half"),
        ("Jane\0Joe", "Jane Joe"),  # EXIF 2.32, Copyright: photographer, NUL, editor
        ("a\x1b[2Jb\x85c\u2028d\u202ee", "a [2Jb c d e"),
        ("two\r\nlines", "two lines"),
        (ValueError("what"), "what"),
        (rawpy.LibRawError(b"Donn\xe9es"), "Données"),
        (UnicodeDecodeError("utf-8", b"bad \xb5 here", 4, 5, "start"), "bad µ here"),
        (OSError(2, "No such file"), "[Errno 2] No such file"),
        ("x" * 60_000, "x" * (LONGEST - 1) + "…"),
    ],
)
def test_examples(said: object, text: str) -> None:
    assert plain_text(said) == text


def test_lines_are_kept_where_asked_for() -> None:
    assert plain_text("two\r\nlines\0", lines=True) == "two\nlines"


@given(ANYTHING, st.booleans())
def test_any_text_can_be_stored_and_printed(said: object, lines: bool) -> None:
    text = plain_text(said, lines=lines)
    stored = sqlite3.connect(":memory:").execute("SELECT ?", (text,)).fetchone()[0]
    assert stored == text == text.encode().decode() == json.loads(json.dumps(text))
    seen = text.replace("\n", "").replace("\t", "") if lines else text
    assert not any(unicodedata.category(character) in ("Cc", "Cs") for character in seen)
    assert len(text) <= LONGEST


@given(ANYTHING)
def test_plain_text_stays_as_it_is(said: object) -> None:
    once = plain_text(said)
    assert plain_text(once) == once


def test_a_complaint_that_is_not_utf_8_is_told_all_the_same() -> None:
    assert complaint(b"damag\xe9".decode) == "damagé"
    assert complaint(lambda: "two\nlines") == "two\nlines"


@pytest.mark.parametrize(
    ("tag", "attribute"),
    [(271, "Make"), (272, "Model"), (305, "Software"), (315, "Artist"), (33432, "Copyright")],
)
def test_exif_in_latin_1_reaches_the_exr_as_text(tmp_path: Path, tag: int, attribute: str) -> None:
    _, jpeg = cv2.imencode(".jpg", np.full((16, 16, 3), 128, np.uint8))
    path = tmp_path / "a.jpg"
    path.write_bytes(with_segments(jpeg.tobytes(), app1(exif_of({tag: b"Jos\xe9\0"}))))
    photo = read_photo(path)
    if attribute in ("Make", "Model", "Software"):
        assert getattr(photo.camera, attribute.lower()) == "José"
    exr = write_exr(tmp_path / "a.exr", photo.encoded, photo, provenance={}).path
    assert written_attribute(exr, attribute) == "José"


def written_attribute(path: Path, name: str) -> str:
    import OpenImageIO as oiio  # noqa: N813, PLC0415

    return str(oiio.ImageBuf(str(path)).spec().get_string_attribute(name))


def test_a_decoder_that_quotes_bytes_of_the_file(tmp_path: Path) -> None:
    content = (
        bytes.fromhex("762f310102000000") + b"channels\0chl\x9b\xfe\0" + b"\x10\0\0\0" + bytes(64)
    )
    path = tmp_path / "a.exr"
    path.write_bytes(content)
    with pytest.raises(PhotoError, match=r"begins as OpenEXR, .*\(EXR Error: EXR_ERR"):
        read_photo(path)
