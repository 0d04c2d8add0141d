"""Files that are no photos, or no longer."""

from __future__ import annotations

import os
import tracemalloc
from pathlib import Path
from typing import Any

import pytest
from photo_files import enlarge_header, random_codes
from PIL import Image

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.photo.read import read_photo


class TestBadInput:
    """Each gives one line: which file, what is wrong, what to do."""

    @staticmethod
    def complaint(path: Path) -> str:
        with pytest.raises(PhotoError) as caught:
            read_photo(path)
        text = str(caught.value)
        assert text.startswith(f"{path}: ")
        assert "; " in text
        assert "\n" not in text
        return text

    def test_png_chunk_that_claims_gigabytes(self, tmp_path: Path) -> None:
        path = tmp_path / "a.png"
        Image.fromarray(random_codes()).save(path)
        content = bytearray(path.read_bytes())
        content[8 + 25 : 8 + 29] = b"\x7f\xff\xff\xff"  # the length of what follows IHDR
        path.write_bytes(content)
        tracemalloc.start()
        assert "cut short" in self.complaint(path)
        assert tracemalloc.get_traced_memory()[1] < 10_000_000
        tracemalloc.stop()

    def test_missing(self, tmp_path: Path) -> None:
        assert "does not exist" in self.complaint(tmp_path / "a.jpg")

    def test_folder(self, tmp_path: Path) -> None:
        assert "is a folder" in self.complaint(tmp_path)

    @pytest.mark.parametrize("name", ["a.jpg", "a.png", "a.tif", "a.exr", "a.dng"])
    def test_zero_bytes(self, tmp_path: Path, name: str) -> None:
        (tmp_path / name).touch()
        assert "is empty" in self.complaint(tmp_path / name)

    @pytest.mark.parametrize("name", ["a.jpg", "a.png", "a.tif", "a.exr", "a.xyz", "a"])
    def test_text(self, tmp_path: Path, name: str) -> None:
        (tmp_path / name).write_text("This is not a photo.\n" * 50)
        assert "not an image" in self.complaint(tmp_path / name)

    def test_pipe(self, tmp_path: Path) -> None:
        os.mkfifo(tmp_path / "a.jpg")
        assert "not a regular file" in self.complaint(tmp_path / "a.jpg")

    def test_no_permission(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        path = tmp_path / "a.png"
        Image.fromarray(random_codes()).save(path)

        def refuse(*args: object, **kwargs: object) -> None:
            raise PermissionError(13, "Permission denied")

        monkeypatch.setattr(Path, "open", refuse)  # file modes do not stop root
        assert "permission" in self.complaint(path)

    def test_the_null_format_of_openimageio(self, tmp_path: Path) -> None:
        (tmp_path / "a.null").write_text("x")
        assert "no image" in self.complaint(tmp_path / "a.null")

    @pytest.mark.parametrize(
        ("name", "options"),
        [
            ("a.jpg", {}),
            ("a.jpg", {"progressive": True}),
            ("a.png", {}),
            ("a.tif", {}),
            ("a.tif", {"compression": "tiff_lzw"}),
            ("a.webp", {}),
            ("a.bmp", {}),
        ],
    )
    @pytest.mark.parametrize("kept", [0.1, 0.5, 0.9, 0.99])
    def test_cut_short(
        self, tmp_path: Path, name: str, options: dict[str, Any], kept: float
    ) -> None:
        image = Image.fromarray(random_codes()).resize((400, 300), Image.Resampling.BICUBIC)
        image.save(tmp_path / name, **options)
        content = (tmp_path / name).read_bytes()
        (tmp_path / name).write_bytes(content[: int(kept * len(content))])
        assert "copy it again" in self.complaint(tmp_path / name)

    def test_damaged_png(self, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
        Image.fromarray(random_codes()).save(tmp_path / "a.png")
        content = bytearray((tmp_path / "a.png").read_bytes())
        content[len(content) // 2] ^= 0xFF
        (tmp_path / "a.png").write_bytes(content)
        assert "checksum" in self.complaint(tmp_path / "a.png")
        assert capfd.readouterr().err == ""

    @pytest.mark.parametrize("name", ["a.jpg", "a.png", "a.bmp", "a.gif", "a.jp2", "a.tif"])
    def test_a_header_of_two_hundred_megapixels(self, tmp_path: Path, name: str) -> None:
        Image.fromarray(random_codes()).save(tmp_path / name)
        enlarge_header(tmp_path / name, 20000, 10000)
        text = self.complaint(tmp_path / name)
        assert "20000 x 10000 pixels, 200 megapixels" in text
        assert "scale it down" in text
