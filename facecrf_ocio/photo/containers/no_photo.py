"""What a file is that no decoder takes for a picture, by the bytes it begins with."""

from __future__ import annotations

from facecrf_ocio.photo.containers.integrity import COPY_AGAIN

_DOWNLOAD = "download the photo again"
_FRAMES = "calibrate it as a clip, or export a frame as PNG"
_UNPACK = "unpack it, and use the photos inside"
_EXPORT = "export the picture in it as PNG or TIFF"
# Of text in lower case, after white space and a byte order mark.
_TEXTS = (
    (
        b"version https://git-lfs",
        "is Git LFS's pointer to the photo",
        "run git lfs pull",
    ),
    (b"<!doctype html", "is a web page, as a failed download leaves it", _DOWNLOAD),
    (b"<html", "is a web page, as a failed download leaves it", _DOWNLOAD),
    (b"<svg", "is a drawing (SVG), and no photo", "use a photo"),
    (b"<?xml", "is XML, as a failed download leaves it", _DOWNLOAD),
    (b"%pdf", "is a PDF", _EXPORT),
    (b"%!ps", "is PostScript", _EXPORT),
    (b"data:image/", "is a picture written as text (base64)", "decode it"),
    (b"/9j/", "is a JPEG written as text (base64)", "decode it: base64 -d"),
    (b"ivborw0kggo", "is a PNG written as text (base64)", "decode it: base64 -d"),
    (b"{", "is text (JSON), as services keep it beside a photo", "name the photo"),
)
# As their bytes are, at their place.
_BYTES = (
    (4, b"ftyp", "is a video", _FRAMES),
    (0, b"\x1a\x45\xdf\xa3", "is a video (Matroska or WebM)", _FRAMES),
    (8, b"AVI ", "is a video (AVI)", _FRAMES),
    (0, b"PK\x03\x04", "is a ZIP archive", _UNPACK),
    (0, b"\x1f\x8b", "is compressed by gzip", _UNPACK),
    (0, b"7z\xbc\xaf\x27\x1c", "is a 7z archive", _UNPACK),
    (0, b"Rar!", "is a RAR archive", _UNPACK),
    (0, b"\x00\x05\x16\x07", "is what macOS keeps beside a file (AppleDouble)", "name the photo"),
    (0, b"bplist00", "is a property list, as iCloud leaves it in a photo's place", _DOWNLOAD),
)


def no_photo(head: bytes) -> tuple[str, str] | None:
    """What is wrong with a file that begins so, and what to do; None where that is not known.

    Parameters
    ----------
    head
        The first bytes; 64 at least, if there are as many.
    """
    if head and not any(head):
        return "begins with zeros alone: it was never written, or is lost", COPY_AGAIN
    text = head.removeprefix(b"\xef\xbb\xbf").lstrip()[:64].lower()
    if text.startswith(b"<?xml") and b"<svg" in head.lower():
        text = b"<svg"
    if text.startswith(b"#?") and b"FORMAT=32-bit_rle_xyze" in head:
        return "is Radiance in CIE XYZ, which is not read here", "convert it with ra_xyze -r"
    for start, problem, remedy in _TEXTS:
        if text.startswith(start):
            return problem, remedy
    for at, magic, problem, remedy in _BYTES:
        if head[at : at + len(magic)] == magic:
            return problem, remedy
    return None
