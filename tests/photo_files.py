"""Photo and LUT files for tests, and what other readers make of them."""

from __future__ import annotations

import struct
import subprocess
import sys
import zlib
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813
import pytest
from PIL import Image

from facecrf_ocio.values import InverseCRF

HEIGHT, WIDTH = 24, 40
OIIOTOOL = Path(sys.executable).parent / "oiiotool"
GRID = np.linspace(0, 1, 4096)
CURVE = InverseCRF(GRID, np.stack([GRID**2.2, GRID**1.8, 0.2 * GRID + 0.8 * GRID**3]))


def random_codes(channels: int = 3, dtype: type = np.uint8) -> npt.NDArray[Any]:
    shape = (HEIGHT, WIDTH, channels)
    return np.random.default_rng(7).integers(0, np.iinfo(dtype).max, shape, dtype, endpoint=True)


def write(path: Path, pixels: npt.NDArray[Any], kind: Any, names: Any = None, **said: Any) -> Path:
    """Write with OpenImageIO; `said` are attributes, `__` standing for `:`."""
    height, width, count = pixels.shape
    spec = oiio.ImageSpec(width, height, count, kind)
    if names is not None:
        spec.channelnames = names
    for name, value in said.items():
        spec.attribute(name.replace("__", ":"), value)
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec), output.geterror()
    assert output.write_image(np.ascontiguousarray(pixels)), output.geterror()
    output.close()
    return path


BRADFORD = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)
D50 = np.array([0.9642, 1.0, 0.8249])


def matrix_profile(*xy: tuple[float, float], gamma: float = 2.2, version: int = 4) -> bytes:
    """A matrix ICC profile of red, green, blue and white, adapted to D50 by Bradford."""
    xyz = np.array([(x / y, 1, (1 - x - y) / y) for x, y in xy])
    white = xyz[3]
    rgb_to_xyz = xyz[:3].T * np.linalg.solve(xyz[:3].T, white)
    chad = np.linalg.inv(BRADFORD) @ np.diag((BRADFORD @ D50) / (BRADFORD @ white)) @ BRADFORD
    colorants = (chad @ rgb_to_xyz).T

    def fixed(*values: float) -> bytes:
        return b"".join(struct.pack(">i", round(value * 65536)) for value in values)

    tags = {
        key: b"XYZ \0\0\0\0" + fixed(*colorant)
        for key, colorant in zip((b"rXYZ", b"gXYZ", b"bXYZ"), colorants, strict=True)
    }
    curve = b"curv\0\0\0\0" + struct.pack(">IH", 1, round(gamma * 256)) + b"\0\0"
    tags.update(dict.fromkeys((b"rTRC", b"gTRC", b"bTRC"), curve))
    tags[b"wtpt"] = b"XYZ \0\0\0\0" + fixed(*(D50 if version == 4 else white))
    if version == 4:
        tags[b"chad"] = b"sf32\0\0\0\0" + fixed(*chad.ravel())
    table, body = b"", b""
    for key, value in tags.items():
        table += key + struct.pack(">II", 132 + 12 * len(tags) + len(body), len(value))
        body += value
    content = struct.pack(">I", len(tags)) + table + body
    header = (
        struct.pack(
            ">I4sI4s4s4s", 128 + len(content), b"lcms", version << 24, b"mntr", b"RGB ", b"XYZ "
        )
        + bytes(12)
        + b"acsp"
    )
    header = header.ljust(68, b"\0") + fixed(*D50)
    return header.ljust(128, b"\0") + content


def write_dng(
    path: Path,
    mosaic: npt.NDArray[np.float64],
    *,
    picture: bytes = b"",
    software: bytes = b"",
    **tags: tuple[int, ...],
) -> Path:
    """The smallest DNG (1.4): one uncompressed RGGB mosaic, neutral white balance.

    `picture` is a JPEG beside it, `software` who signs. More tags are shorts, by number:
    `t50714=(512,)` is its black level.
    """
    height, width = mosaic.shape
    data = mosaic.astype("<u2").tobytes()
    xyz_to_camera = (3.2405, -1.5371, -0.4985, -0.9693, 1.876, 0.0416, 0.0556, -0.204, 1.0572)
    short, long, ascii_, byte, rational, signed = 3, 4, 2, 1, 5, 10

    def ratios(*values: float) -> bytes:
        return b"".join(struct.pack("<ii", round(value * 10000), 10000) for value in values)

    entries = [
        (254, long, 1, struct.pack("<I", 0)),
        (256, long, 1, struct.pack("<I", width)),
        (257, long, 1, struct.pack("<I", height)),
        (258, short, 1, struct.pack("<H", 16)),
        (259, short, 1, struct.pack("<H", 1)),
        (262, short, 1, struct.pack("<H", 32803)),
        (271, ascii_, 5, b"Acme\0"),
        (272, ascii_, 8, b"Raw One\0"),
        (273, long, 1, b""),  # offset of the strip, filled in below
        (274, short, 1, struct.pack("<H", 1)),
        (277, short, 1, struct.pack("<H", 1)),
        (278, long, 1, struct.pack("<I", height)),
        (279, long, 1, struct.pack("<I", len(data))),
        (33421, short, 2, struct.pack("<HH", 2, 2)),
        (33422, byte, 4, bytes([0, 1, 1, 2])),
        (50706, byte, 4, bytes([1, 4, 0, 0])),
        (50708, ascii_, 8, b"Raw One\0"),
        (50717, long, 1, struct.pack("<I", 65535)),
        (50721, signed, 9, ratios(*xyz_to_camera)),
        (50728, rational, 3, ratios(1, 1, 1)),
        (50778, short, 1, struct.pack("<H", 21)),
    ]
    for name, shorts in tags.items():
        packed = struct.pack(f"<{len(shorts)}H", *shorts)
        entries = [entry for entry in entries if entry[0] != int(name[1:])]
        entries.append((int(name[1:]), short, len(shorts), packed))
    if software:
        entries.append((305, ascii_, len(software) + 1, software + b"\0"))
    beside = [
        (254, long, 1, struct.pack("<I", 1)),  # a smaller picture of the same
        (259, short, 1, struct.pack("<H", 7)),
        (262, short, 1, struct.pack("<H", 6)),
        (258, short, 3, struct.pack("<HHH", 8, 8, 8)),
        (273, long, 1, b""),
        (277, short, 1, struct.pack("<H", 3)),
        (279, long, 1, struct.pack("<I", len(picture))),
    ]
    if picture:
        with Image.open(BytesIO(picture)) as opened:
            beside += [(256 + n, long, 1, struct.pack("<I", s)) for n, s in enumerate(opened.size)]
            beside.append((278, long, 1, struct.pack("<I", opened.height)))
    first, end = _directory(8, entries, data, followed=bool(picture))
    second, _ = _directory(end, beside, picture, followed=False) if picture else (b"", end)
    path.write_bytes(b"II*\0" + struct.pack("<I", 8) + first + second)
    return path


def _directory(
    start: int, entries: list[tuple[int, int, int, bytes]], data: bytes, *, followed: bool
) -> tuple[bytes, int]:
    """A directory of a TIFF with its values and its one strip, and where it ends."""
    beyond = start + 2 + 12 * len(entries) + 4
    strip = beyond + sum(len(value) for *_, value in entries if len(value) > 4)
    table, values = struct.pack("<H", len(entries)), b""
    for tag, kind, count, given_value in sorted(entries):
        value = given_value or struct.pack("<I", strip)
        if len(value) > 4:
            value, values = struct.pack("<I", beyond + len(values)), values + value
        table += struct.pack("<HHI", tag, kind, count) + value.ljust(4, b"\0")
    end = strip + len(data)
    end += end % 2
    written = table + struct.pack("<I", end if followed else 0) + values + data
    return written.ljust(end - start, b"\0"), end


def enlarge_header(path: Path, width: int, height: int) -> None:
    """Let a file's header claim another size than its pixels have."""
    content = bytearray(path.read_bytes())
    if path.suffix == ".png":
        content[16:24] = struct.pack(">II", width, height)
        content[29:33] = struct.pack(">I", zlib.crc32(content[12:29]))
    elif path.suffix == ".bmp":
        content[18:26] = struct.pack("<ii", width, height)
    elif path.suffix == ".jpg":
        struct.pack_into(">HH", content, content.index(b"\xff\xc0") + 5, height, width)
    elif path.suffix == ".gif":
        content[6:10] = struct.pack("<HH", width, height)
    elif path.suffix == ".jp2":
        for start, order in (
            (content.index(b"ihdr") + 4, (height, width)),
            (content.index(b"\xff\x4f\xff\x51") + 8, (width, height)),
        ):
            content[start : start + 8] = struct.pack(">II", *order)
    else:
        for tag, value in ((256, width), (257, height)):
            entry = next(
                at
                for at in range(len(content) - 12)
                if struct.unpack_from("<HHI", content, at) in ((tag, 3, 1), (tag, 4, 1))
            )
            struct.pack_into("<HHII", content, entry, tag, 4, 1, value)
    path.write_bytes(content)


def write_spi1d(path: Path, curve: InverseCRF = CURVE) -> Path:
    rows = "\n".join(" ".join(f"{value:.9g}" for value in row) for row in curve.linear.T)
    size = curve.encoded.size
    path.write_text(f"Version 1\nFrom 0 1\nLength {size}\nComponents 3\n{{\n{rows}\n}}\n")
    return path


def pixels_of(path: Path) -> npt.NDArray[np.float32]:
    return np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT))


def oiiotool(photo: Path, lut: Path, result: Path) -> npt.NDArray[np.float32]:
    """What OpenImageIO's own tool makes of a photo and a LUT."""
    if not OIIOTOOL.exists():
        pytest.skip("this OpenImageIO was installed without oiiotool")
    command = [OIIOTOOL, photo, "-d", "float", "--ociofiletransform", lut, "-d", "float"]
    subprocess.run([*command, "-o", result], check=True)
    return pixels_of(result)


def exif_of(tags: dict[int, bytes | int]) -> bytes:
    """EXIF (little-endian TIFF) of one directory: texts as bytes with their NUL, or shorts."""
    entries = sorted(tags.items())
    table, values = struct.pack("<H", len(entries)), b""
    beyond = 8 + 2 + 12 * len(entries) + 4
    for tag, said in entries:
        kind, count = (2, len(said)) if isinstance(said, bytes) else (3, 1)
        value = said if isinstance(said, bytes) else struct.pack("<H", said)
        if len(value) > 4:
            value, values = struct.pack("<I", beyond + len(values)), values + value
        table += struct.pack("<HHI", tag, kind, count) + value.ljust(4, b"\0")
    return b"II*\0" + struct.pack("<I", 8) + table + bytes(4) + values


def app1(exif: bytes) -> bytes:
    """A JPEG's segment of EXIF."""
    return segment(0xE1, b"Exif\0\0" + exif)


def segment(marker: int, content: bytes) -> bytes:
    return bytes([0xFF, marker]) + struct.pack(">H", len(content) + 2) + content


def with_segments(jpeg: bytes, *segments: bytes) -> bytes:
    """A JPEG with more segments right after its start."""
    return jpeg[:2] + b"".join(segments) + jpeg[2:]
