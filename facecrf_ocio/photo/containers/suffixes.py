"""The kinds of photo files: their suffixes, the bytes they start with, and who reads them.

The one table of them all: whoever looks for photos, or opens one, asks here.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePath

HEAD = 1 << 16
"""[byte] Of a file's beginning that `kind_of` may be given; it needs the first 32."""

IMAGE, RAW, HEIF = "image", "raw", "heif"
"""Who reads a kind: OpenImageIO, LibRaw, or the extra `heif`."""


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of photo files.

    Attributes
    ----------
    name
        As it is told to users.
    reader
        `IMAGE`, `RAW` or `HEIF`.
    suffixes
        In lower case, with their dot.
    starts
        (offset, bytes) that every file of the kind has there; empty where there are none.
    """

    name: str
    reader: str
    suffixes: tuple[str, ...]
    starts: tuple[tuple[int, bytes], ...] = ()

    def fits(self, head: bytes) -> bool:
        """Whether a file that starts so is of this kind."""
        return any(head[at : at + len(magic)] == magic for at, magic in self.starts)


def _dotted(names: str) -> tuple[str, ...]:
    return tuple(f".{name}" for name in names.split())


_BRANDS = "heic heix heim heis hevc hevx hevm hevs mif1 mif2 msf1 avif avis"  # ISO 23008-12, AVIF
# Suffixes as OpenImageIO and LibRaw (its list of cameras, and what their software writes) know
# them; of film scans and games only what holds photos. Fixed bytes as published for each format.
KINDS = (
    Kind("JPEG", IMAGE, _dotted("jpg jpeg jpe jif jfif jfi mpo"), ((0, b"\xff\xd8\xff"),)),
    Kind("PNG", IMAGE, _dotted("png"), ((0, b"\x89PNG\r\n\x1a\n"),)),
    Kind("GIF", IMAGE, _dotted("gif"), ((0, b"GIF8"),)),
    Kind("WebP", IMAGE, _dotted("webp"), ((8, b"WEBP"),)),
    Kind(
        "JPEG 2000",
        IMAGE,
        _dotted("jp2 j2k j2c jph"),
        ((4, b"jP  "), (0, b"\xff\x4f\xff\x51")),
    ),
    Kind("JPEG XL", IMAGE, _dotted("jxl"), ((4, b"JXL \r\n\x87\n"), (0, b"\xff\x0a"))),
    Kind("OpenEXR", IMAGE, _dotted("exr sxr mxr"), ((0, b"\x76\x2f\x31\x01"),)),
    Kind("Radiance HDR", IMAGE, _dotted("hdr rgbe"), ((0, b"#?RADIANCE"), (0, b"#?RGBE"))),
    Kind("Photoshop", IMAGE, _dotted("psd psb"), ((0, b"8BPS"),)),
    Kind("BMP", IMAGE, _dotted("bmp dib"), ((0, b"BM"),)),
    Kind("Netpbm", IMAGE, _dotted("ppm pgm pbm pnm pfm")),
    Kind("Targa", IMAGE, _dotted("tga tpic")),
    Kind("DPX", IMAGE, _dotted("dpx"), ((0, b"SDPX"), (0, b"XPDS"))),
    Kind("Cineon", IMAGE, _dotted("cin"), ((0, b"\x80\x2a\x5f\xd7"),)),
    Kind(
        "HEIC or AVIF",
        HEIF,
        _dotted("heic heif hif heics avif"),
        tuple((4, b"ftyp" + brand.encode()) for brand in _BRANDS.split()),
    ),
    Kind(
        "camera raw",
        RAW,
        _dotted(
            "3fr ari arw bay bmq cap cine cr2 cr3 crw cs1 cxi dc2 dcr dcs drf dsc eip erf fff gpr "
            "iiq k25 kc2 kdc mdc mef mfw mos mrw nef nrw orf ori pef ptx pxn qtk raf raw rdc rw2 "
            "rwl rwz sr2 srf srw sti x3f"
        ),
        (
            *(
                (0, b"FUJIFILMCCD-RAW"),
                (4, b"ftypcrx "),
                (0, b"IIU\0"),
                (0, b"\0MRM"),
                (0, b"FOVb"),
            ),
            *((0, b"IIRO"), (0, b"IIRS"), (0, b"MMOR"), (6, b"HEAPCCDR"), (0, b"ARRI")),
        ),
    ),
    # Camera raw may be one as well, whatever its name: `tiff_pages.holds_raw` tells.
    Kind("DNG", RAW, _dotted("dng")),
    Kind(
        "TIFF",
        IMAGE,
        _dotted("tif tiff"),
        ((0, b"II*\0"), (0, b"MM\0*"), (0, b"II+\0"), (0, b"MM\0+")),
    ),
)

_OF_SUFFIX = {suffix: kind for kind in KINDS for suffix in kind.suffixes}
PHOTO_SUFFIXES = frozenset(_OF_SUFFIX)
"""What is taken for a photo where only names are looked at."""

RAW_SUFFIXES = frozenset(suffix for suffix, kind in _OF_SUFFIX.items() if kind.reader == RAW)


def kind_of(head: bytes) -> Kind | None:
    """Kind of the file that starts with these bytes; None where they tell of none."""
    return next((kind for kind in KINDS if kind.fits(head)), None)


def kind_named(path: PurePath) -> Kind | None:
    """Kind that a file's suffix claims; None for any other suffix."""
    return _OF_SUFFIX.get(path.suffix.lower())


def suffixes_named(*names: str) -> frozenset[str]:
    """Suffixes of the kinds of these names."""
    return frozenset(suffix for suffix, kind in _OF_SUFFIX.items() if kind.name in names)
