"""Video files by PyAV (the extra `video`): frames as RGB, range and matrix as the stream says."""

from __future__ import annotations

from bisect import bisect
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from facecrf_ocio.clip.frame_list import Clip, in_one_size
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.content import sha256_of
from facecrf_ocio.photo.tags.cicp import LINEAR, TRANSFERS
from facecrf_ocio.values import Photo

_UNEVEN = 1.5  # longest distance between frames over the shortest: a rate that varies
# [s] and share of its length by which a header tells more than there is before a file is called cut
# short: sound may go on a little behind the pictures.
_SHORT_S, _SHORT = 0.25, 0.05
# [byte] of a packet of transport streams (ITU-T H.222.0), of which a whole file has a whole number;
# those of discs have a time stamp of 4 bytes before each.
_PACKETS = (188, 192)
_STREAMS = (".ts", ".mts", ".m2ts")
_HD_ROWS = 720  # [px] from which streams that state no matrix mean BT.709's


def open_video(path: Path) -> Clip:
    """List the frames of a video's first stream of pictures.

    Raises
    ------
    PhotoError
        If PyAV is not installed, or the file is no video that it reads.
    """
    av = _pyav(path)
    try:
        with av.open(str(path)) as container:
            if not container.streams.video:
                raise PhotoError(path, "has sound and no pictures", "give a video with a face")
            stream = container.streams.video[0]
            told = float(container.duration or 0) / av.time_base  # by the header, where it tells
            packets = [
                (packet.pts, packet.is_keyframe)
                for packet in container.demux(stream)
                if packet.pts is not None
            ]
            stamps = sorted(stamp for stamp, _ in packets)
            keys = sorted(stamp for stamp, is_key in packets if is_key)
            base = float(stream.time_base or 1.0)
            rate = float(stream.average_rate or 24.0)
            motion_jpeg = stream.codec_context.name == "mjpeg"
    except (av.error.FFmpegError, OSError) as error:
        raise _unreadable(path, error) from error
    there = (stamps[-1] - stamps[0]) * base + 1.0 / rate if stamps else 0.0
    notes = filter(None, (_uneven(stamps), _cut_short(path, told, there)))

    def read(indices: Sequence[int]) -> Iterator[tuple[int, Photo]]:
        frames = _frames(path, [stamps[index] for index in indices], keys)
        return in_one_size(zip(indices, frames, strict=True))

    return Clip(
        path,
        path.name,
        tuple((stamp - stamps[0]) * base for stamp in stamps),
        tuple(f"{path.name} frame {index}" for index in range(len(stamps))),
        rate,
        read,
        tuple(notes),
        motion_jpeg,
    )


def _uneven(stamps: Sequence[int]) -> str:
    """What is to be told of frames that come at a rate that varies."""
    steps = np.diff(stamps) if len(stamps) > 1 else np.ones(1)
    if float(steps.max()) > _UNEVEN * max(float(steps.min()), 1e-9):
        return "its frame rate varies: frames are chosen and named by their own times"
    return ""


def _cut_short(path: Path, told: float, there: float) -> str:
    """What is to be told of a file whose end is lost, of `told` seconds of which some are there."""
    if told - there > max(_SHORT_S, _SHORT * told):
        return (
            f"it is cut short: its header tells {told:.1f} s and {there:.1f} s are there, "
            "which are used"
        )
    if path.suffix.lower() in _STREAMS and all(path.stat().st_size % of for of in _PACKETS):
        return f"it is cut short: it ends within a packet; {there:.1f} s are there"
    return ""


def _unreadable(path: Path, error: Exception) -> PhotoError:
    kind = b""
    with suppress(OSError), path.open("rb") as file:  # what cannot be opened has its own error
        kind = file.read(8)[4:]
    if kind in (b"ftyp", b"mdat", b"wide"):
        problem = (
            "cannot be read: it is cut short or damaged; MP4 and MOV have their index at the end"
        )
        return PhotoError(path, problem, "copy it again")
    return PhotoError(path, f"is no video that can be read ({error})", "convert it")


def _pyav(path: Path) -> Any:
    try:
        import av  # noqa: PLC0415 -- an extra
    except ImportError as error:
        raise PhotoError(
            path, "is a video, which PyAV reads", "install it: pip install 'facecrf-ocio[video]'"
        ) from error
    return av


def _frames(path: Path, stamps: Sequence[int], keys: Sequence[int]) -> Iterator[Photo]:
    """Photos of the frames with these time stamps; `keys`, sorted, are those that need no other.

    Seeks where a key frame lies on the way, and else goes on decoding, as a seek would begin at the
    last key frame again. Of one that is damaged the next that is not takes the place, at the end of
    a file the last.
    """
    av, sha256 = _pyav(path), sha256_of(path)
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        stream.thread_type = "AUTO"
        coming, at = _whole(av, container), None
        for stamp in stamps:
            if at is None or stamp <= at or bisect(keys, stamp) > bisect(keys, at):
                container.seek(stamp, stream=stream, backward=True)
                coming = _whole(av, container)
            frame = _first(coming, stamp)
            at = stamp if frame is not None and frame.pts == stamp else None
            if frame is None or frame.pts != stamp:
                # Transport streams have no index, and a seek in them may go too far.
                with av.open(str(path)) as anew:
                    frame = _first(_whole(av, anew), stamp)
            if frame is None:
                raise PhotoError(path, "has no frame that can be decoded", "copy it again")
            yield _photo(frame, int(stream.codec_context.color_trc or 0), path, sha256)


def _whole(av: Any, container: Any) -> Iterator[Any]:
    """Frames as they come, but for those that are damaged."""
    packets = container.demux(container.streams.video[0])
    while True:
        try:
            yield from next(packets).decode()
        except StopIteration:
            return
        except av.error.InvalidDataError:
            continue


def _first(frames: Iterable[Any], stamp: int) -> Any:
    """The first frame at a time stamp or later, else the last one; None if there is none."""
    frame = None
    for frame in frames:
        if (frame.pts or 0) >= stamp:
            break
    return frame


def _photo(frame: Any, transfer: int, path: Path, sha256: str) -> Photo:
    """Code values as the camera meant them: a limited range is stretched to the full one."""
    deep = max(component.bits for component in frame.format.components) > 8
    kind = "rgb48le" if deep else "rgb24"
    stated = {1: "ITU709", 5: "ITU601", 6: "ITU601", 9: "ITU709"}.get(int(frame.colorspace))
    matrix = stated or ("ITU709" if frame.height >= _HD_ROWS else "ITU601")
    full = int(frame.color_range) == 2
    turned = frame.reformat(
        format=kind,
        src_colorspace=matrix,
        src_color_range="JPEG" if full else "MPEG",
        dst_color_range="JPEG",
    )
    codes = turned.to_ndarray()
    curve = TRANSFERS.get(transfer, "")
    encoded = codes.astype(np.float32) / np.float32(65535 if deep else 255)
    return Photo(
        encoded,
        bit_depth=16 if deep else 8,
        scene_linear=curve == LINEAR,
        named_curve="" if curve == LINEAR else curve,
        path=path,
        sha256=sha256,
    )
