"""Photos as no camera should write them: each a name and its bytes, small enough to look into."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterable

import cv2
import numpy as np
from photo_files import matrix_profile
from PIL import Image

REC709 = ((0.64, 0.33), (0.3, 0.6), (0.15, 0.06), (0.3127, 0.329))
CODES = np.random.default_rng(5).integers(0, 256, (24, 32, 3), np.uint8)
# Types of EXIF and TIFF.
BYTE, ASCII, SHORT, LONG, RATIONAL, UNDEFINED, SRATIONAL, DOUBLE = 1, 2, 3, 4, 5, 7, 10, 12
_SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 6: 1, 7: 1, 8: 2, 9: 4, 10: 8, 11: 4, 12: 8}
Entry = tuple[int, int, int, bytes]


def jpeg(**how: object) -> bytes:
    out = io.BytesIO()
    Image.fromarray(CODES).save(out, "JPEG", **{"quality": 95, **how})
    return out.getvalue()


def png(**how: object) -> bytes:
    out = io.BytesIO()
    Image.fromarray(CODES).save(out, "PNG", **how)
    return out.getvalue()


def directory(entries: Iterable[Entry], *, order: str = "<", following: int = 0) -> bytes:
    """A TIFF of one directory; an entry is a tag, a type, a count and the bytes of its value."""
    rows, more = b"", b""
    listed = sorted(entries)
    start = 8 + 2 + 12 * len(listed) + 4
    for tag, kind, count, value in listed:
        if len(value) > 4:
            place = struct.pack(order + "I", start + len(more))
            more += value + bytes(len(value) % 2)
        else:
            place = value.ljust(4, b"\0")
        rows += struct.pack(order + "HHI", tag, kind, count) + place
    mark = b"II*\0" if order == "<" else b"MM\0*"
    head = mark + struct.pack(order + "I", 8) + struct.pack(order + "H", len(listed))
    return head + rows + struct.pack(order + "I", following) + more


def text(tag: int, value: bytes) -> Entry:
    return tag, ASCII, len(value), value


def segment(marker: int, body: bytes) -> bytes:
    return bytes((0xFF, marker)) + struct.pack(">H", len(body) + 2) + body


def with_segments(*segments: bytes, photo: bytes = b"") -> bytes:
    photo = photo or jpeg()
    return photo[:2] + b"".join(segments) + photo[2:]


def with_exif(*entries: Entry, order: str = "<", following: int = 0) -> bytes:
    body = b"Exif\0\0" + directory(entries, order=order, following=following)
    return with_segments(segment(0xE1, body))


def with_exif_bytes(body: bytes) -> bytes:
    return with_segments(segment(0xE1, b"Exif\0\0" + body))


def with_xmp(body: bytes) -> bytes:
    return with_segments(segment(0xE1, b"http://ns.adobe.com/xap/1.0/\0" + body))


def with_profile(profile: bytes, *, number: int = 1, of: int = 1) -> bytes:
    return with_segments(segment(0xE2, b"ICC_PROFILE\0" + bytes((number, of)) + profile))


def chunk(kind: bytes, body: bytes) -> bytes:
    check = struct.pack(">I", zlib.crc32(kind + body))
    return struct.pack(">I", len(body)) + kind + body + check


def with_chunks(*chunks: bytes) -> bytes:
    photo = png()
    return photo[:33] + b"".join(chunks) + photo[33:]


def exif_photos() -> dict[str, bytes]:
    loop = directory([text(0x010F, b"Acme\0")], following=8)
    nested = [(0x8769, LONG, 1, struct.pack("<I", 8))]  # the directory of EXIF is this one
    far = [(0x010F, ASCII, 4000, struct.pack("<I", 0xFFFFFFF0))]
    many = struct.pack("<H", 65535) + b"\x0f\x01\x02\x00" * 300
    return {
        "description_utf16.jpg": with_exif(text(0x010E, "Bäume".encode("utf-16"))),
        "artist_shift_jis.jpg": with_exif(text(0x013B, "写真家".encode("shift_jis") + b"\0")),
        "copyright_cp1251.jpg": with_exif(text(0x8298, "Фото".encode("cp1251") + b"\0")),
        "make_nul_within.jpg": with_exif(text(0x010F, b"A\0c\0m\xe9\0\0")),
        "model_escapes.jpg": with_exif(text(0x0110, b"\x1b]0;x\x07\x1b[2J\r\n\xff\0")),
        "software_60000.jpg": with_exif(text(0x0131, b"\xe9" * 60000)),
        "comment_jis.jpg": with_exif((0x9286, UNDEFINED, 13, b"JIS\0\0\0\0\0\x1b$B\xff\xfe")),
        "title_odd_utf16.jpg": with_exif((0x9C9B, BYTE, 7, b"\x00\xd8A\x00\xdc\x00\xff")),
        "orientation_text.jpg": with_exif(text(0x0112, b"6\0")),
        "orientation_0.jpg": with_exif((0x0112, SHORT, 1, b"\0\0")),
        "orientation_65535.jpg": with_exif((0x0112, SHORT, 1, b"\xff\xff")),
        "orientation_long.jpg": with_exif((0x0112, LONG, 1, struct.pack("<I", 6))),
        "orientation_many.jpg": with_exif((0x0112, SHORT, 3, struct.pack("<3H", 6, 8, 3))),
        "exposure_0_0.jpg": with_exif((0x829A, RATIONAL, 1, bytes(8))),
        "exposure_1_0.jpg": with_exif((0x829A, RATIONAL, 1, struct.pack("<II", 1, 0))),
        "exposure_negative.jpg": with_exif((0x829A, SRATIONAL, 1, struct.pack("<ii", -1, 50))),
        "aperture_nan.jpg": with_exif((0x829D, DOUBLE, 1, struct.pack("<d", float("nan")))),
        "iso_0.jpg": with_exif((0x8827, SHORT, 1, b"\0\0")),
        "taken_never.jpg": with_exif(text(0x9003, b"0000:00:00 00:00:00\0")),
        "taken_odd.jpg": with_exif(text(0x9003, b"2020:99:99 \xe9\xe9:61\0")),
        "loop.jpg": with_exif_bytes(loop),
        "nested.jpg": with_exif(*nested),
        "far.jpg": with_exif(*far),
        "big_endian.jpg": with_exif((0x0112, SHORT, 1, b"\0\x06"), order=">"),
        "type_99.jpg": with_exif((0x010F, 99, 5, b"abcde")),
        "count_huge.jpg": with_exif((0x010F, ASCII, 0xFFFFFFFF, b"abcd")),
        "many_entries.jpg": with_exif_bytes(b"II*\0\x08\0\0\0" + many),
        "cut_exif.jpg": with_exif_bytes(b"II*\0\x08"),
        "no_tiff.jpg": with_exif_bytes(b"\xff" * 40),
        "two_exifs.jpg": with_segments(
            *[
                segment(0xE1, b"Exif\0\0" + directory([(0x0112, SHORT, 1, o)]))
                for o in (b"\6", b"\3")
            ]
        ),
    }


def xmp_photos() -> dict[str, bytes]:
    def said(prefix: str, space: str, value: str) -> bytes:
        return (
            '<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf='
            '"http://www.w3.org/1999/02/22-rdf-syntax-ns#"><rdf:Description rdf:about="" '
            f'xmlns:{prefix}="{space}" {prefix}:Orientation="{value}"/></rdf:RDF></x:xmpmeta>'
        ).encode()

    tiff, exif = "http://ns.adobe.com/tiff/1.0/", "http://ns.adobe.com/exif/1.0/"
    bomb = '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa">' + "".join(
        f'<!ENTITY {chr(98 + n)} "{("&" + chr(97 + n) + ";") * 10}">' for n in range(9)
    )
    return {
        "xmp_other_prefix.jpg": with_xmp(said("t", tiff, "6")),
        "xmp_exif_space.jpg": with_xmp(said("exif", exif, "6")),
        "xmp_spaces.jpg": with_xmp(said("tiff", tiff, " 6\n")),
        "xmp_arabic.jpg": with_xmp(said("tiff", tiff, "٦")),
        "xmp_float.jpg": with_xmp(said("tiff", tiff, "6.0")),
        "xmp_negative.jpg": with_xmp(said("tiff", tiff, "-6")),
        "xmp_5000_digits.jpg": with_xmp(said("tiff", tiff, "6" * 5000)),
        "xmp_utf16.jpg": with_xmp(said("tiff", tiff, "6").decode().encode("utf-16")),
        "xmp_latin1.jpg": with_xmp(said("tiff", tiff, "6").replace(b"adobe:ns", b"\xe9\xff\0ns")),
        "xmp_cut.jpg": with_xmp(said("tiff", tiff, "6")[:90]),
        "xmp_bomb.jpg": with_xmp((bomb + "]><x>&j;</x>").encode()),
        "xmp_deep.jpg": with_xmp(b"<a>" * 15000),
        "xmp_quotes.jpg": with_xmp(b'<x tiff:Orientation="' * 2000),
        "xmp_extended.jpg": with_segments(
            segment(0xE1, b"http://ns.adobe.com/xmp/extension/\0" + b"f" * 32 + b"\xff" * 8)
        ),
    }


def profile_photos() -> dict[str, bytes]:
    whole = matrix_profile(*REC709)

    def tag(name: bytes) -> int:
        """Where a tag's value lies."""
        return int(struct.unpack(">I", whole[whole.index(name, 128) + 4 :][:4])[0])

    def changed(at: int, odd: bytes) -> bytes:
        return whole[:at] + odd + whole[at + len(odd) :]

    most, least = b"\x7f\xff\xff\xff", b"\x80\0\0\0"
    red, curve, white = tag(b"rXYZ"), tag(b"rTRC"), tag(b"wtpt")
    return {
        "icc_most.jpg": with_profile(changed(red + 8, most * 3)),
        "icc_least.jpg": with_profile(changed(red + 8, least * 3)),
        "icc_alike.jpg": with_profile(changed(red + 8, whole[tag(b"gXYZ") + 8 :][:12])),
        "icc_white_0.jpg": with_profile(changed(white + 8, bytes(12))),
        "icc_white_most.jpg": with_profile(changed(white + 8, most * 3)),
        "icc_curve_count.jpg": with_profile(changed(curve + 8, b"\xff\xff\xff\xff")),
        "icc_curve_kind.jpg": with_profile(changed(curve, b"nan\xe9")),
        "icc_size.jpg": with_profile(changed(0, b"\xff\xff\xff\xff")),
        "icc_tags.jpg": with_profile(changed(128, b"\xff\xff\xff\xff")),
        "icc_version.jpg": with_profile(changed(8, b"\xff\xff\xff\xff")),
        "icc_gray.jpg": with_profile(changed(16, b"GRAY")),
        "icc_cmyk.jpg": with_profile(changed(16, b"CMYK")),
        "icc_lab.jpg": with_profile(changed(20, b"Lab ")),
        "icc_cut.jpg": with_profile(whole[:140]),
        "icc_of_2.jpg": with_profile(whole, number=2, of=2),
        "icc_of_0.jpg": with_profile(whole, number=0, of=0),
        "icc_text.png": with_chunks(chunk(b"iCCP", b"caf\xe9\0\0" + zlib.compress(whole))),
        "icc_no_zlib.png": with_chunks(chunk(b"iCCP", b"a\0\0" + b"\xff" * 90)),
        "icc_bomb.png": with_chunks(chunk(b"iCCP", b"a\0\0" + zlib.compress(bytes(50_000_000)))),
    }


def jpeg_photos() -> dict[str, bytes]:
    whole, large = jpeg(), cv2.imencode(".jpg", np.tile(CODES, (8, 8, 1)))[1].tobytes()
    scan = whole.index(b"\xff\xda")
    cmyk = io.BytesIO()
    Image.fromarray(np.dstack([CODES, CODES[..., 0]]), "CMYK").save(cmyk, "JPEG")
    gray = io.BytesIO()
    Image.fromarray(CODES[..., 0]).save(gray, "JPEG")
    frame = whole.index(b"\xff\xc0")
    return {
        "cmyk.jpg": cmyk.getvalue(),
        "gray.jpg": gray.getvalue(),
        "progressive.jpg": jpeg(progressive=True),
        "progressive_cut.jpg": jpeg(progressive=True)[:-200],
        "filled.jpg": whole[:2] + b"\xff" * 50 + whole[2:],
        "zeros_between.jpg": whole[:2] + bytes(9) + whole[2:],
        "end_cut.jpg": whole[:-2],
        "end_cut_large.jpg": large[:-2],
        "end_twice.jpg": whole + b"\xff\xd9",
        "two_photos.jpg": whole + whole,
        "two_begins.jpg": whole[:2] + whole,
        "film_behind.jpg": whole + b"\0\0\0\x18ftypmp42" + b"\xff\xd8\xff" * 500,
        "text_behind.jpg": whole + b"<html>" * 100,
        "stray_before_scan.jpg": whole[:scan] + b"\x12\x34" + whole[scan:],
        "stray_before_frame.jpg": whole[:frame] + b"\0\xff\0" + whole[frame:],
        "comment_bytes.jpg": with_segments(segment(0xFE, bytes(range(256)))),
        "empty_segment.jpg": with_segments(segment(0xE5, b"")),
        "segment_too_short.jpg": with_segments(b"\xff\xe5\0\1"),
        "segment_too_long.jpg": with_segments(b"\xff\xe5\xff\xff"),
        "adobe_odd.jpg": with_segments(segment(0xEE, b"Adobe\0\x64\0\0\0\0\x09")),
        "height_0.jpg": whole[: frame + 5] + b"\0\0" + whole[frame + 7 :],
        "restart_odd.jpg": whole[: scan + 60] + b"\xff\xd3" + whole[scan + 60 :],
        "half.jpg": whole[: len(whole) // 2],
        "one_pixel.jpg": cv2.imencode(".jpg", CODES[:1, :1])[1].tobytes(),
        "begin_alone.jpg": whole[:2],
    }


def strip(pixels: bytes, width: int, height: int, *more: Entry, order: str = "<") -> bytes:
    """A TIFF of one strip that is not compressed; its pixels come last."""

    def made(offset: int) -> bytes:
        size = {"H": order + "H", "I": order + "I"}
        known = {tag for tag, *_ in more}
        entries = [
            (0x0100, LONG, 1, struct.pack(size["I"], width)),
            (0x0101, LONG, 1, struct.pack(size["I"], height)),
            (0x0103, SHORT, 1, struct.pack(size["H"], 1)),
            (0x0111, LONG, 1, struct.pack(size["I"], offset)),
            (0x0116, LONG, 1, struct.pack(size["I"], height)),
            (0x0117, LONG, 1, struct.pack(size["I"], len(pixels))),
        ]
        return directory([*(e for e in entries if e[0] not in known), *more], order=order)

    return made(len(made(0))) + pixels


def kind(bits: int, photometric: int, samples: int = 1, form: int = 1) -> list[Entry]:
    """Entries that say what pixels are; forms are 1 for whole numbers and 3 for floats."""
    each = struct.pack("<H", bits) * samples
    return [
        (0x0102, SHORT, samples, each),
        (0x0106, SHORT, 1, struct.pack("<H", photometric)),
        (0x0115, SHORT, 1, struct.pack("<H", samples)),
        (0x0153, SHORT, samples, struct.pack("<H", form) * samples),
    ]


def pages(*frames: np.ndarray) -> bytes:
    out = io.BytesIO()
    first, *rest = [Image.fromarray(frame) for frame in frames]
    first.save(out, "TIFF", save_all=True, append_images=rest)
    return out.getvalue()


def tiff_photos() -> dict[str, bytes]:
    gray = CODES[..., 0]
    deep = gray.astype("<u2") * 257
    floats = gray.astype("<f4") / 255
    odd = floats.copy()
    odd[3, 4:8] = np.nan, np.inf, -np.inf, -5.0
    rgb = (CODES.astype("<f4") / 255).copy()
    rgb[0, 0] = np.nan
    size = (32, 24)
    whole = pages(CODES)
    return {
        "white_8.tif": strip(gray.tobytes(), *size, *kind(8, 0)),
        "white_16.tif": strip(deep.tobytes(), *size, *kind(16, 0)),
        "white_float.tif": strip(floats.tobytes(), *size, *kind(32, 0, form=3)),
        "white_1.tif": strip(np.packbits(gray > 128, axis=1).tobytes(), *size, *kind(1, 0)),
        "black_4.tif": strip(
            (gray[:, ::2] & 0xF0 | gray[:, 1::2] >> 4).tobytes(), *size, *kind(4, 1)
        ),
        "gray_odd_floats.tif": strip(odd.tobytes(), *size, *kind(32, 1, form=3)),
        "rgb_odd_floats.tif": strip(rgb.tobytes(), *size, *kind(32, 2, 3, 3)),
        "double.tif": strip(floats.astype("<f8").tobytes(), *size, *kind(64, 1, form=3)),
        "int_32.tif": strip(gray.astype("<u4").tobytes(), *size, *kind(32, 1)),
        "signed_16.tif": strip(gray.astype("<i2").tobytes(), *size, *kind(16, 1, form=2)),
        "lab.tif": strip(CODES.tobytes(), *size, *kind(8, 8, 3)),
        "cmyk.tif": strip(np.dstack([CODES, gray]).tobytes(), *size, *kind(8, 5, 4)),
        "ycbcr.tif": strip(CODES.tobytes(), *size, *kind(8, 6, 3)),
        "five.tif": strip(np.dstack([CODES, gray, gray]).tobytes(), *size, *kind(8, 2, 5)),
        "two.tif": strip(np.dstack([gray, gray]).tobytes(), *size, *kind(8, 1, 2)),
        "no_map.tif": strip(gray.tobytes(), *size, *kind(8, 3)),
        "kind_99.tif": strip(CODES.tobytes(), *size, *kind(8, 99, 3)),
        "bits_7.tif": strip(CODES.tobytes(), *size, *kind(7, 2, 3)),
        "cut_strip.tif": strip(CODES.tobytes(), *size, *kind(8, 2, 3))[:-900],
        "width_0.tif": strip(CODES.tobytes(), 0, 24, *kind(8, 2, 3)),
        "width_huge.tif": strip(CODES.tobytes(), 0x7FFFFFFF, 0x7FFFFFFF, *kind(8, 2, 3)),
        "loop.tif": whole[:4] + whole[4:8] + whole[8:-4] + whole[4:8],
        "small_first.tif": pages(CODES[:6, :8], CODES),
        "small_last.tif": pages(CODES, CODES[:6, :8]),
        "alike.tif": pages(CODES, 255 - CODES, CODES),
        "gray_and_color.tif": pages(gray, CODES),
        "hundred_pages.tif": pages(*[CODES[:4, :4]] * 100),
        "big_tiff_cut.tif": b"II+\0\x08\0\0\0" + b"\xff" * 30,
        "no_directory.tif": b"II*\0\0\0\0\0",
        "far_directory.tif": b"MM\0*\xff\xff\xff\xf0",
        "description.tif": strip(
            CODES.tobytes(), *size, *kind(8, 2, 3), text(0x010E, b"\xe9\xff{'shape': (2,")
        ),
    }


def png_photos() -> dict[str, bytes]:
    whole = png()
    one = struct.pack(">I", 1)
    return {
        "gamma_0.png": with_chunks(chunk(b"gAMA", bytes(4))),
        "gamma_most.png": with_chunks(chunk(b"gAMA", b"\xff" * 4)),
        "colors_0.png": with_chunks(chunk(b"cHRM", bytes(32))),
        "colors_alike.png": with_chunks(chunk(b"cHRM", (struct.pack(">I", 31270) * 8))),
        "colors_most.png": with_chunks(chunk(b"cHRM", b"\xff" * 32)),
        "intent_9.png": with_chunks(chunk(b"sRGB", b"\x09")),
        "signal_reserved.png": with_chunks(chunk(b"cICP", bytes((3, 99, 7, 9)))),
        "signal_short.png": with_chunks(chunk(b"cICP", b"\1")),
        "exif_odd.png": with_chunks(chunk(b"eXIf", b"\xff" * 30)),
        "exif_loop.png": with_chunks(chunk(b"eXIf", directory([text(1, b"a\0")], following=8))),
        "text_latin.png": with_chunks(chunk(b"tEXt", b"caf\xe9\0" + bytes(range(256)))),
        "text_bomb.png": with_chunks(chunk(b"zTXt", b"a\0\0" + zlib.compress(bytes(90_000_000)))),
        "text_utf8.png": with_chunks(chunk(b"iTXt", b"a\0\0\0\xff\0\xfe\0\xe9\xff")),
        "animated.png": with_chunks(chunk(b"acTL", b"\xff" * 8), chunk(b"fcTL", bytes(26))),
        "unknown.png": with_chunks(chunk(b"ABCD", b"x")),
        "wrong_sum.png": whole[:-20] + b"\0" + whole[-19:],
        "end_cut.png": whole[:-12],
        "behind.png": whole + b"x" * 90,
        "density.png": with_chunks(chunk(b"pHYs", bytes(9))),
        "size_0.png": whole[:16] + bytes(8) + whole[24:],
        "size_huge.png": whole[:8] + chunk(b"IHDR", b"\x7f\xff\xff\xff" * 2 + b"\x08\2\0\0\0"),
        "depth_3.png": whole[:8] + chunk(b"IHDR", one * 2 + b"\x03\2\0\0\0") + whole[33:],
        "head_alone.png": whole[:8],
        "gray_alpha.png": cv2.imencode(".png", np.dstack([CODES, CODES[..., 0]]))[1].tobytes(),
    }


def other_photos() -> dict[str, bytes]:
    bmp = cv2.imencode(".bmp", CODES)[1].tobytes()
    hdr = cv2.imencode(".hdr", CODES.astype(np.float32) / 255)[1].tobytes()
    exr = b"v/1\1\2\0\0\0"
    webp = io.BytesIO()
    frames = [Image.fromarray(CODES), Image.fromarray(255 - CODES)]
    frames[0].save(webp, "WEBP", save_all=True, append_images=frames[1:])
    gif = io.BytesIO()
    frames[0].save(gif, "GIF", save_all=True, append_images=frames[1:])
    return {
        "animated.webp": webp.getvalue(),
        "animated.gif": gif.getvalue(),
        "cut.webp": webp.getvalue()[:60],
        "size.webp": webp.getvalue()[:4] + b"\xff" * 4 + webp.getvalue()[8:],
        "upside.bmp": bmp[:22] + struct.pack("<i", -24) + bmp[26:],
        "height_least.bmp": bmp[:22] + b"\0\0\0\x80" + bmp[26:],
        "offset.bmp": bmp[:10] + b"\xff" * 4 + bmp[14:],
        "cut.bmp": bmp[:-300],
        "head.hdr": hdr.replace(b"FORMAT=32", b"EXPOSURE=nan\nFORMAT=32"),
        "size.hdr": hdr.replace(b"-Y 24 +X 32", b"-Y 99999999 +X 99999999"),
        "lines.hdr": b"#?RADIANCE\n" + b"A=1\n" * 9000,
        "head_alone.exr": exr,
        "names.exr": exr + b"chan\xe9\0chlist\0" + b"\xff" * 90,
        "head.pfm": b"PF\n32 24\nnan\n" + bytes(9216),
        "size.pfm": b"PF\n-3 99999999999\n-1\n",
        "size.ppm": b"P6 32 24 65536\n" + bytes(99),
        "digits.ppm": b"P6 " + b"9" * 5000,
        "comment.ppm": b"P6\n#\xe9\xff\n32 24 255\n" + CODES.tobytes(),
        "cut.tga": b"\0\0\x0a" + bytes(9) + b"\xff\xff\xff\xff\x18\0",
        "head.psd": b"8BPS\0\1" + b"\xff" * 40,
        "head.jp2": b"\0\0\0\x0cjP  \r\n\x87\n" + b"\xff" * 60,
        "head.heic": b"\0\0\0\x18ftypheic" + b"\xff" * 60,
        "head.avif": b"\0\0\0\x18ftypavif" + b"\xff" * 60,
        "head.jxl": b"\xff\x0a" + b"\xff" * 60,
        "box.jxl": b"\0\0\0\x0cJXL \r\n\x87\n" + b"\xff" * 60,
        "head.dpx": b"SDPX" + b"\xff" * 2044,
        "head.cin": b"\x80\x2a\x5f\xd7" + b"\xff" * 2044,
        "head.cr2": b"II*\0\x10\0\0\0CR\2\0" + b"\xff" * 90,
        "head.cr3": b"\0\0\0\x18ftypcrx " + b"\xff" * 90,
        "head.raf": b"FUJIFILMCCD-RAW " + b"\xff" * 200,
        "head.nef": b"MM\0*\0\0\0\x08\xff\xff" + b"\xff" * 90,
        "head.x3f": b"FOVb" + b"\xff" * 90,
        "tags.dng": directory([(0xC612, BYTE, 4, b"\xff" * 4), text(0xC614, b"\xe9\0")]),
        "drawing.svg": b"<svg xmlns='http://www.w3.org/2000/svg'/>",
        "page.jpg": b"<!DOCTYPE html><title>404</title>",
        "nothing.jpg": b"",
        "zeros.png": bytes(4096),
        "mark.tif": b"\xef\xbb\xbfII*\0",
    }


def odd_photos() -> dict[str, bytes]:
    """Every photo by its name; a folder of its own would hold each kind."""
    kinds = (exif_photos, xmp_photos, profile_photos, jpeg_photos, tiff_photos)
    return {
        f"{made.__name__.partition('_')[0]} {name}": content
        for made in (*kinds, png_photos, other_photos)
        for name, content in made().items()
    }
