"""JPEGs that end early: what decoders fill up, or take for a coarser picture, is refused."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.photo.read import read_photo


def picture():
    """(240, 320, 3) soft colors with some grain."""
    y, x = np.mgrid[:240, :320] / 320.0
    soft = np.stack([x, y, 1.0 - x], axis=-1) * 200.0
    noise = np.random.default_rng(3).normal(0.0, 6.0, soft.shape)
    return Image.fromarray(np.clip(soft + noise + 20.0, 0, 255).astype(np.uint8))


def jpeg(**how):
    out = io.BytesIO()
    picture().save(out, "JPEG", **how)
    return out.getvalue()


def scans(content):
    """Where the scans of a progressive JPEG and the tables before them begin."""
    return [at for at in range(len(content)) if content[at : at + 2] == b"\xff\xda"]


def refusal(path, content):
    path.write_bytes(content)
    with pytest.raises(PhotoError) as told:
        read_photo(path)
    assert "copy it again from the camera or from a backup" in str(told.value)
    return str(told.value)


@pytest.mark.parametrize("end", [b"", b"\xff\xd9"])
def test_a_progressive_jpeg_without_its_last_scans_is_cut_short(tmp_path, end):
    """Each is a valid, coarser picture to a decoder."""
    content = jpeg(progressive=True, quality=90)
    for at in scans(content)[1:]:
        told = refusal(tmp_path / "a.jpg", content[:at] + end)
        assert "is cut short (scans of a progressive JPEG are missing)" in told


def test_a_progressive_jpeg_with_all_of_them_is_read(tmp_path):
    for how in ({}, {"subsampling": 0}, {"optimize": True}):
        (tmp_path / "a.jpg").write_bytes(jpeg(progressive=True, quality=90, **how))
        assert read_photo(tmp_path / "a.jpg").notes == ()
    picture().convert("L").save(tmp_path / "gray.jpg", progressive=True)
    assert read_photo(tmp_path / "gray.jpg").grayscale


@pytest.mark.parametrize("quality", [75, 90, 95, 100])
@pytest.mark.parametrize("share", [0.5, 0.9, 0.99])
def test_zeros_in_the_place_of_the_last_bytes_are_no_pixels(tmp_path, quality, share):
    """What a download leaves that was broken off: zeros are codes, of which a picture gets full."""
    content = jpeg(quality=quality)
    kept = round(share * len(content))
    zeros = bytes(4 * (len(content) - kept))
    assert "is cut short" in refusal(tmp_path / "a.jpg", content[:kept] + zeros)


@pytest.mark.parametrize("fill", [b"", bytes(3), bytes(4000), b"\xff" * 4000])
def test_a_whole_picture_without_its_end_is_read(tmp_path, fill):
    content = jpeg(quality=92)
    (tmp_path / "whole.jpg").write_bytes(content)
    (tmp_path / "a.jpg").write_bytes(content[:-2] + fill)
    photo = read_photo(tmp_path / "a.jpg")
    assert (photo.encoded == read_photo(tmp_path / "whole.jpg").encoded).all()
    assert photo.notes == ("the mark that ends the JPEG is missing, and no pixel with it",)
