"""Clips: sequences and videos in, one curve out; ranges and named curves respected."""

from __future__ import annotations

import json
import re
from fractions import Fraction

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from archive_photos import linear_face, write_picture
from command_line import CommandLine

from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.clip.calibrate_clip import calibrate_clip
from facecrf_ocio.clip.clip_source import open_clip
from facecrf_ocio.clip.exr_sequence import timecode, write_sequence
from facecrf_ocio.clip.video import open_video
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.image.exr_header import packed
from facecrf_ocio.synthetic import encode, gamma_curve
from facecrf_ocio.values import Outcome

CURVE = gamma_curve(2.2)
RAMP = np.tile(np.linspace(0, 1, 64, dtype=np.float32)[None, :, None], (48, 1, 3))


def sequence(folder, count, name="frame.{:04d}.png", size=64):
    for n in range(count):
        write_picture(folder / name.format(n + 1), RAMP[:, :size], CURVE)
    return folder


def write_video(path, frames, *, full=False, trc=None, stamps=None, bits=20_000_000, keys=12):
    """H.264 by libx264 of (H, W, 3) code values, [0, 1], with a key frame every so many."""
    av = pytest.importorskip("av")
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=24)
        stream.width, stream.height = frames[0].shape[1], frames[0].shape[0]
        stream.pix_fmt, stream.bit_rate, stream.gop_size = "yuv420p", bits, keys
        stream.codec_context.color_range = 2 if full else 1
        stream.codec_context.colorspace = 1
        if trc is not None:
            stream.codec_context.color_trc = trc
        for number, codes in enumerate(frames):
            pixels = np.rint(codes * 255).astype(np.uint8)
            frame = av.VideoFrame.from_ndarray(pixels, format="rgb24").reformat(
                format="yuv420p",
                dst_colorspace="ITU709",
                src_color_range="JPEG",
                dst_color_range="JPEG" if full else "MPEG",
            )
            frame.pts = number if stamps is None else stamps[number]
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    return path


def cut_short(*paths):
    for path in paths:
        data = path.read_bytes()
        path.write_bytes(data[: len(data) // 2])


class TestFrames:
    @pytest.mark.parametrize("pattern", ["frame.%04d.png", "frame.####.png", ""])
    def test_a_pattern_or_folder_is_a_clip_in_the_order_of_its_numbers(self, tmp_path, pattern):
        sequence(tmp_path, 3)
        write_picture(tmp_path / "frame.0010.png", RAMP, CURVE)
        clip = open_clip(tmp_path / pattern if pattern else tmp_path)
        assert clip.names == tuple(f"frame.{n:04d}.png" for n in (1, 2, 3, 10))
        assert clip.rate == 24.0

    @pytest.mark.parametrize(
        ("pattern", "name"),
        [("a.v2.####.png", "a.v2.png"), ("a_%04d.png", "a.png"), ("%d.png", "clip.png")],
    )
    def test_its_name_is_the_frames_without_their_numbers(self, tmp_path, pattern, name):
        for n in (1001, 1002):
            write_picture(tmp_path / re.sub(r"#+|%0?4?d", str(n), pattern), RAMP, CURVE)
        assert open_clip(tmp_path / pattern).name == name

    def test_numbers_without_leading_zeros_are_numbers(self, tmp_path):
        for n in (9, 10, 11):
            write_picture(tmp_path / f"f{n}.png", RAMP, CURVE)
        assert open_clip(tmp_path).names == ("f9.png", "f10.png", "f11.png")
        assert open_clip(tmp_path / "f%d.png").names == ("f9.png", "f10.png", "f11.png")

    @pytest.mark.parametrize("full", [True, False])
    def test_both_ranges_of_a_video_give_the_same_codes(self, tmp_path, full):
        path = write_video(tmp_path / "a.mp4", [RAMP] * 3, full=full)
        ((_, photo),) = open_clip(path).read([1])
        assert np.abs(photo.encoded.mean(axis=0) - RAMP.mean(axis=0)).max() < 0.02

    def test_a_frame_is_the_one_that_was_asked_for(self, tmp_path):
        path = write_video(tmp_path / "a.mp4", [RAMP * (n / 40) for n in range(41)])
        levels = [p.encoded.mean() for _, p in open_clip(path).read([3, 20, 37])]
        assert levels == pytest.approx([0.5 * n / 40 for n in (3, 20, 37)], abs=0.01)

    @pytest.mark.parametrize("keys", [4, 100])
    def test_frames_come_as_asked_for_whether_they_follow_one_another_or_not(self, tmp_path, keys):
        path = write_video(tmp_path / "a.mp4", [RAMP * (n / 40) for n in range(31)], keys=keys)
        wanted = [0, 1, 2, 3, 4, 5, 9, 9, 7, 8, 30, 29, 12]
        levels = [p.encoded.mean() for _, p in open_clip(path).read(wanted)]
        assert levels == pytest.approx([0.5 * n / 40 for n in wanted], abs=0.01)


@pytest.mark.parametrize(("trc", "name"), [(16, "PQ"), (18, "HLG"), (9, "log 100:1")])
def test_a_curve_that_the_stream_names_is_used(tmp_path, trc, name):
    clip = open_clip(write_video(tmp_path / "a.mp4", [RAMP] * 3, trc=trc))
    estimate = calibrate_clip(clip).estimate
    assert estimate.outcome is Outcome.NAMED
    assert name in estimate.reason


@pytest.mark.parametrize(("trc", "darkest"), [(9, 1 / 100), (10, 10**-2.5)])
def test_a_logarithm_that_the_stream_names_is_undone(tmp_path, trc, darkest):
    clip = open_clip(write_video(tmp_path / "a.mp4", [RAMP] * 3, trc=trc))
    curve = calibrate_clip(clip).estimate.curve
    light = curve.linearize(np.full((1, 1, 3), 0.5, np.float32))
    assert light == pytest.approx(darkest**0.5, rel=1e-3)


def test_time_codes_count_frames():
    assert timecode(0.0, 24.0) == "00:00:00:00"
    assert timecode(3661.5, 24.0) == "01:01:01:12"
    assert timecode(1.0, 29.97) == "00:00:01:00"


@pytest.mark.parametrize(
    ("told", "rate", "digits"),
    [
        ("01:02:03:04", 24.0, 0x01020304),
        ("23:59:58:29", 29.97, 0x23595829),
        ("00:00:00:59", 60.0, 0x00000029),  # the 30th pair of frames
    ],
)
def test_a_time_code_is_packed_as_decimal_digits(told, rate, digits):
    assert packed(told, rate) == digits


def test_frames_written_have_the_time_code_that_openexr_has(tmp_path):
    clip = open_clip(sequence(tmp_path / "in", 30))
    estimate = calibrate(clip.first([0]), estimator="srgb")
    written = [exr.path for exr, _ in write_sequence(clip, lambda _: estimate, tmp_path / "out")]
    spec = oiio.ImageInput.open(str(written[25])).spec()
    assert spec.get_string_attribute("smpte:TimeCode") == "00:00:01:01"
    assert spec.getattribute("smpte:TimeCode")[0] == 0x00000101
    # A run that was broken off goes on: only what is not there is written.
    written[3].unlink()
    there = [was for _, was in write_sequence(clip, lambda _: estimate, tmp_path / "out")]
    assert there.count(False) == 1
    # One that lost its end since, and has its header, is no frame.
    whole = written[5].read_bytes()
    written[5].write_bytes(whole[:-100])
    there = [was for _, was in write_sequence(clip, lambda _: estimate, tmp_path / "out")]
    assert there.count(False) == 1
    assert written[5].read_bytes() == whole


class TestBadInput:
    def told(self, given):
        with pytest.raises(PhotoError) as caught:
            open_clip(given)
        return str(caught.value)

    def test_one_frame(self, tmp_path):
        sequence(tmp_path, 1)
        assert "has one frame, and is no clip" in self.told(tmp_path)
        assert "is one picture, and no clip" in self.told(tmp_path / "frame.0001.png")

    def test_nothing(self, tmp_path):
        assert "has no frames; check the folder" in self.told(tmp_path / "frame.####.jpg")
        assert "does not exist" in self.told(tmp_path / "none.mp4")

    def test_mixed_sizes(self, tmp_path):
        sequence(tmp_path, 2)
        write_picture(tmp_path / "frame.0003.png", RAMP[:, :50], CURVE)
        with pytest.raises(PhotoError, match="has 50 x 48 pixels, frames before it 64 x 48"):
            list(open_clip(tmp_path).read([0, 1, 2]))

    def test_a_video_whose_size_changes_midway(self, tmp_path):
        """Motion JPEG, of which each frame tells its own size."""
        av = pytest.importorskip("av")
        path = tmp_path / "a.mkv"
        with av.open(str(path), "w") as container:
            stream = container.add_stream("mjpeg", rate=24)
            stream.width, stream.height, stream.pix_fmt = 64, 48, "yuvj420p"
            larger = av.CodecContext.create("mjpeg", "w")
            larger.width, larger.height, larger.pix_fmt = 128, 96, "yuvj420p"
            larger.time_base = Fraction(1, 24)
            for number in range(6):
                coder, size = (stream, 1) if number < 4 else (larger, 2)
                codes = np.rint(RAMP * 255).astype(np.uint8).repeat(size, 0).repeat(size, 1)
                frame = av.VideoFrame.from_ndarray(codes, format="rgb24")
                frame.pts, frame.time_base = number, Fraction(1, 24)
                for packet in coder.encode(frame.reformat(format="yuvj420p")):
                    packet.stream, packet.pts, packet.dts = stream, number, number
                    packet.time_base = Fraction(1, 24)
                    container.mux(packet)
        clip = open_clip(path)
        with pytest.raises(PhotoError, match=r"a\.mkv: has 128 x 96 pixels, .* it 64 x 48; give"):
            list(clip.read([0, 3, 5]))

    def test_a_frame_that_cannot_be_read_is_left_out_and_named(self, tmp_path):
        sequence(tmp_path, 5)
        cut_short(tmp_path / "frame.0001.png", tmp_path / "frame.0004.png")
        clip = open_clip(tmp_path)
        assert [index for index, _ in clip.read(range(5))] == [1, 2, 4]
        assert clip.first(range(5)).path == tmp_path / "frame.0002.png"
        told = "2 frames cannot be read: frame.0001.png, frame.0004.png; the first is cut short"
        assert clip.left_out().startswith(told)

    def test_of_many_that_cannot_be_read_some_are_named(self, tmp_path):
        sequence(tmp_path, 12)
        cut_short(*(tmp_path / f"frame.{n:04d}.png" for n in range(2, 13)))
        clip = open_clip(tmp_path)
        list(clip.read(range(12)))
        assert "frame.0009.png and 3 more; the first" in clip.left_out()
        with pytest.raises(PhotoError, match=r"frame\.0002\.png: is cut short"):
            calibrate_clip(clip)

    def test_a_transport_stream_is_read_though_it_cannot_be_sought_in(self, tmp_path):
        steps = [np.full_like(RAMP, level) for level in np.linspace(0.1, 0.9, 9)]
        clip = open_clip(write_video(tmp_path / "a.ts", steps))
        found = [float(photo.encoded.mean()) for _, photo in clip.read(range(9))]
        assert found == pytest.approx(np.linspace(0.1, 0.9, 9), abs=0.02)

    def test_no_video(self, tmp_path):
        pytest.importorskip("av")
        (tmp_path / "a.mp4").write_bytes(b"nothing" * 100)
        assert "is no video that can be read" in self.told(tmp_path / "a.mp4")

    def test_a_rate_that_varies_is_told(self, tmp_path):
        path = write_video(tmp_path / "a.mp4", [RAMP] * 5, stamps=(0, 1, 2, 8, 9))
        assert "its frame rate varies" in open_clip(path).notes[0]

    @pytest.mark.parametrize(
        ("missing", "said"),
        [
            ((), ()),
            ((4,), ("1 frame is missing (4)",)),
            ((3, 4, 7), ("3 frames are missing (3 to 4 and others)",)),
        ],
    )
    def test_frames_that_are_missing_are_told(self, tmp_path, missing, said):
        sequence(tmp_path, 9)
        for number in missing:
            (tmp_path / f"frame.{number:04d}.png").unlink()
        told = open_clip(tmp_path / "frame.%04d.png").notes
        assert tuple(note.partition(":")[0] for note in told) == said

    def test_pictures_whose_numbers_are_far_apart_miss_nothing(self, tmp_path):
        for number in (17, 230, 4711):
            write_picture(tmp_path / f"IMG_{number}.png", RAMP, CURVE)
        assert open_clip(tmp_path).notes == ()

    def test_a_video_that_is_cut_short_is_told_and_used_as_far_as_it_goes(self, tmp_path):
        noise = np.random.default_rng(0).random((24, 48, 64, 3)).astype(np.float32)
        whole = write_video(tmp_path / "a.mkv", list(noise))
        assert open_clip(whole).notes == ()
        data = whole.read_bytes()
        (tmp_path / "b.mkv").write_bytes(data[: len(data) // 2])
        clip = open_clip(tmp_path / "b.mkv")
        assert 4 < len(clip.times) < 20
        assert clip.notes[0].startswith("it is cut short: its header tells 1.0 s and 0.")
        assert clip.first([len(clip.times) - 1]).shape[:2] == (48, 64)

    def test_a_transport_stream_that_is_cut_short_ends_within_a_packet(self, tmp_path):
        noise = np.random.default_rng(0).random((16, 48, 64, 3)).astype(np.float32)
        whole = write_video(tmp_path / "a.ts", list(noise))
        assert open_clip(whole).notes == ()
        data = whole.read_bytes()
        (tmp_path / "b.ts").write_bytes(data[: 188 * (len(data) // 376) + 37])
        clip = open_clip(tmp_path / "b.ts")
        assert [note.partition(";")[0] for note in clip.notes] == [
            "it is cut short: it ends within a packet"
        ]
        assert clip.first([len(clip.times) - 1]).shape[:2] == (48, 64)

    def test_an_mp4_that_is_cut_short_has_lost_its_index(self, tmp_path):
        data = write_video(tmp_path / "a.mp4", [RAMP] * 4).read_bytes()
        (tmp_path / "b.mp4").write_bytes(data[: len(data) // 2])
        said = self.told(tmp_path / "b.mp4")
        assert "cut short or damaged; MP4 and MOV have their index at the end; copy it ag" in said

    def test_the_place_of_a_damaged_frame_is_taken_by_the_next(self, tmp_path):
        steps = [np.full_like(RAMP, level) for level in np.linspace(0.2, 0.8, 12)]
        grain = np.random.default_rng(0).normal(0.0, 0.05, RAMP.shape)
        path = write_video(tmp_path / "a.mp4", [step + grain for step in steps])
        data = bytearray(path.read_bytes())
        media = data.index(b"mdat")
        middle = media + (data.index(b"moov") - media) // 2
        data[middle : middle + 3000] = bytes(3000)
        path.write_bytes(data)
        assert len(list(open_clip(path).read(range(12)))) == 12

    def test_sound_without_pictures(self, tmp_path):
        av = pytest.importorskip("av")
        with av.open(str(tmp_path / "a.mp4"), "w") as container:
            stream = container.add_stream("aac", rate=48000)
            frame = av.AudioFrame.from_ndarray(
                np.zeros((1, 4096), np.float32), format="fltp", layout="mono"
            )
            frame.rate, frame.pts = 48000, 0
            container.mux(stream.encode(frame))
            container.mux(stream.encode(None))
        assert "has sound and no pictures" in self.told(tmp_path / "a.mp4")

    @pytest.mark.slow
    def test_no_face_in_any_frame(self, capfd, tmp_path):
        ended = CommandLine(capfd)("clip", sequence(tmp_path / "in", 3), "-o", tmp_path / "out")
        assert ended.code == 4
        assert "no frame that was looked at shows a face" in ended.err


@pytest.mark.slow
def test_a_compressed_clip_with_moving_exposure_gives_its_curve_and_frames(capfd, tmp_path):
    frames = []
    for n in range(12):
        light = np.clip(linear_face(3) * np.float32(2.0 ** (-0.5 + n / 12)), 0, 1)
        frames.append(encode(np.roll(light, n, axis=1), CURVE))
    path = write_video(tmp_path / "take.mp4", frames, bits=10_000_000)
    command = ("clip", path, "-o", tmp_path / "out", "--frames", "4", "--exr")
    ended = CommandLine(capfd)(*command, "--formats", "spi1d")
    assert ended.code == 0, ended.err
    assert "12 frames" in ended.out
    assert (tmp_path / "out" / "take.mp4.spi1d").exists()
    (tmp_path / "out" / "take.mp4.exr" / "take.mp4.0005.exr").unlink()
    again = CommandLine(capfd)(*command, "--formats", "spi1d")
    assert "12 frames, 11 of them there already" in again.out


@pytest.mark.slow
def test_frames_that_cannot_be_read_cost_neither_the_clip_nor_silence(capfd, tmp_path):
    (tmp_path / "in").mkdir()
    for n in range(9):
        light = np.clip(linear_face(3) * np.float32(2.0 ** (-0.5 + n / 9)), 0, 1)
        write_picture(tmp_path / "in" / f"frame.{n + 1:04d}.png", light, CURVE)
    cut_short(tmp_path / "in" / "frame.0001.png", tmp_path / "in" / "frame.0005.png")
    command = ("clip", tmp_path / "in", "-o", tmp_path / "out", "--exr", "--formats", "spi1d")
    ended = CommandLine(capfd)(*command, "--frames", "1")  # three are looked at: 1, 5 and 9
    assert ended.code == 3  # as it was before: one that is left is no clip
    ended = CommandLine(capfd)(*command, "--frames", "2")
    assert ended.code == 3
    told = "2 frames cannot be read: frame.0001.png, frame.0005.png; the first is cut short"
    assert f"note: {told}" in ended.out
    assert f"{told} (the PNG ends early); without an EXR" in ended.err
    assert "7 frames" in ended.out
    record = json.loads((tmp_path / "out" / "in.crf.json").read_text())
    notes = record["source"]["notes"]
    assert notes[-1].startswith(told)
    assert any(note.startswith("frames ") and note.endswith(" of 9") for note in notes)
    assert any("the curve" in note and "drift" in note for note in notes)
    exrs = {path.name for path in (tmp_path / "out" / "in.exr").iterdir()}
    assert exrs == {f"in.{n:04d}.exr" for n in (2, 3, 4, 6, 7, 8, 9)}


def test_a_video_that_cannot_be_opened_is_told_as_that(tmp_path):
    pytest.importorskip("av", reason="needs the extra video")
    with pytest.raises(PhotoError, match=r"is no video that can be read .*No such file"):
        open_video(tmp_path / "gone.mp4")


def test_a_compression_without_exrs_is_wrong_usage(capfd, tmp_path):
    pattern = sequence(tmp_path / "clip", 2)
    ended = CommandLine(capfd)("clip", pattern, "-o", tmp_path / "luts", "--compression", "piz")
    assert (ended.code, "pass --exr, too" in ended.err) == (2, True)
    assert not (tmp_path / "luts").exists()
