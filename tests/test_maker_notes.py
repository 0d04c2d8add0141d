"""What makers' notes say of curves that cameras bend to scenes, and what follows from it."""

from __future__ import annotations

import json
import struct
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from face_photos import grace_hopper
from hypothesis import given, settings
from hypothesis import strategies as st
from maker_note_files import (
    BYTES,
    LONG,
    NOTES,
    SHORT,
    SIGNED_LONG,
    SIGNED_SHORT,
    Tags,
    exif_with,
    footed,
)
from photo_files import app1, write_dng
from PIL import Image, features

from facecrf_ocio import calibrate, calibrate_together, read_photo
from facecrf_ocio.benchmark.peers.drawn_chart import lit_chart, shot
from facecrf_ocio.cameras.known_cameras import shipped_cameras
from facecrf_ocio.chart.calibrate_chart import calibrate_chart
from facecrf_ocio.joint import PhotoEvidence, conclude
from facecrf_ocio.joint.known_response import OTHER_MODELS, STYLES, known_response
from facecrf_ocio.joint.prior import Message, shipped_prior
from facecrf_ocio.photo.containers.jpeg_segments import take_apart
from facecrf_ocio.photo.tags.adapted import adapted_by
from facecrf_ocio.photo.tags.maker_notes import exif_of, maker_notes
from facecrf_ocio.record.calibration_record import Record
from facecrf_ocio.record.measured import entry, from_record
from facecrf_ocio.record.source_record import source_in, source_of
from facecrf_ocio.settings import Settings
from facecrf_ocio.synthetic import gamma_curve
from facecrf_ocio.values import Camera, Photo, Verdict
from facecrf_ocio.wording.sentence import sentence

NIKON, ACTIVE = "NIKON CORPORATION", {0x22: (SHORT, (0xFFFF,))}
AUTO = "Active D-Lighting (Auto)"
DOUBT = f"perhaps no single curve: {AUTO} bent it to the scene"


def lighting(optimizer: int, priority: int) -> Tags:
    """Canon's LightingOpt: its size, vignetting, and the two that matter."""
    return {0x4018: (SIGNED_LONG, (20, 1, optimizer, priority, 0))}


def custom(*functions: tuple[int, int]) -> Tags:
    """Canon's custom functions in one group, each with one number, behind another group."""
    group = (1, 8 + 4 * 3, 1, 0x101, 1, 0)
    words = [number for tag, value in functions for number in (tag, 1, value)]
    second = (2, 8 + 4 * len(words), len(functions), *words)
    size = 4 * (2 + len(group) + len(second))
    return {0x99: (LONG, (size, 2, *group, *second))}


ON: list[tuple[str, Tags, str]] = [
    (NIKON, ACTIVE, AUTO),
    (NIKON, {0x22: (SHORT, (1,))}, "Active D-Lighting (Low)"),
    (NIKON, {0x22: (SHORT, (0,)), 0x35: (BYTES, (*b"0100", 1, 0, 0, 0))}, "HDR (on)"),
    ("Canon", lighting(0, 0), "Auto Lighting Optimizer (Standard)"),
    ("Canon", lighting(3, 1), "Highlight Tone Priority (on)"),
    ("Canon", custom((0x203, 1), (0x204, 1)), "Highlight Tone Priority (on)"),
    ("Canon", custom((0x201, 7), (0x204, 0)), "Auto Lighting Optimizer (Standard)"),
    ("Canon", {0x4025: (SIGNED_LONG, (12, 2, 0))}, "HDR (on)"),
    ("Canon", {0x27: (SHORT, (10, 0, 0, 0, 8))}, "i-Contrast (on)"),
    ("SONY", {0xB025: (LONG, (3,))}, "Dynamic Range Optimizer (Auto)"),
    ("SONY", {0xB04F: (SHORT, (2,))}, "Dynamic Range Optimizer (Plus)"),
    ("SONY", {0x200A: (SHORT, (0x10, 1))}, "HDR (on)"),
    ("OLYMPUS IMAGING CORP.", {0x50F: (SIGNED_SHORT, (0, -1, 1, 1))}, "Gradation (Auto)"),
    ("OLYMPUS OPTICAL CO.,LTD", {0x50F: (SIGNED_SHORT, (0, -1, 1, 1))}, "Gradation (Auto)"),
    ("OM Digital Solutions", {0x804: (LONG, (5, 4))}, "HDR (HDR1)"),
    ("Panasonic", {0x79: (SHORT, (1,))}, "Intelligent D-Range (Low)"),
    ("Panasonic", {0x9E: (SHORT, (32968,))}, "HDR (2 EV, Auto)"),
    ("PENTAX", {0x69: (BYTES, (1, 1, 0, 0))}, "Highlight Correction (on)"),
    ("RICOH IMAGING COMPANY, LTD.", {0x79: (1 + 1, (2, 4))}, "Shadow Correction (Auto)"),
    ("RICOH", {0x100E: (SHORT, (4,))}, "Dynamic Range Compensation (Medium)"),
    ("FUJIFILM", {0x1402: (SHORT, (0,)), 0x140B: (SHORT, (200,))}, "Dynamic Range (Auto, 200 %)"),
    ("FUJIFILM", {0x1402: (SHORT, (1,)), 0x1403: (SHORT, (400,))}, "Dynamic Range (400 %)"),
    ("FUJIFILM", {0x1444: (SHORT, (2,))}, "D Range Priority (Strong)"),
    ("SAMSUNG", {0xA012: (SHORT, (1,))}, "Smart Range (on)"),
]
OFF: list[tuple[str, Tags]] = [
    (NIKON, {0x22: (SHORT, (0,))}),
    (NIKON, {0x22: (SHORT, (4711,))}),  # listed nowhere
    (NIKON, {}),
    ("Canon", lighting(3, 0)),
    ("Canon", custom((0x203, 0), (0x204, 1))),  # which disables it in all but four models
    ("Canon", {0x27: (SHORT, (10, 0, 0, 0, 0xFFFF))}),
    ("SONY", {0xB025: (LONG, (0,)), 0xB04F: (SHORT, (1,))}),  # ExifTool: the latter is less sure
    ("SONY", {0x200A: (SHORT, (0x10, 0))}),  # one exposure, kept beside the HDR picture
    ("OLYMPUS IMAGING CORP.", {0x50F: (SIGNED_SHORT, (1, -1, 1, 0))}),  # high key, by the user
    ("Panasonic", {0x79: (SHORT, (0,))}),
    ("PENTAX", {0x69: (BYTES, (0, 0, 0, 0)), 0x79: (BYTES, (0, 0))}),
    ("FUJIFILM", {0x1402: (SHORT, (0,)), 0x140B: (SHORT, (100,))}),
    ("FUJIFILM", {0x1402: (SHORT, (0,)), 0x1403: (SHORT, (400,))}),  # not by hand: not valid
]


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(("make", "tags", "told"), ON)
def test_a_setting_that_is_on_is_named(make: str, tags: Tags, told: str, order: str) -> None:
    """Whatever EXIF's own order of bytes: programs turn that, and leave that of the notes."""
    if NOTES[make](tags, 0)[:1] in (b"", b"\x01"):
        order = "<"  # notes without a header are in EXIF's order
    assert adapted_by(exif_with(make, tags, order=order)) == (told,)


@pytest.mark.parametrize(("make", "tags"), OFF)
def test_off_and_what_is_not_known_say_nothing(make: str, tags: Tags) -> None:
    assert maker_notes(exif_with(make, tags)).maker
    assert adapted_by(exif_with(make, tags)) == ()


def test_of_four_models_of_canon_a_low_optimizer_is_told_from_none() -> None:
    low, none = custom((0x204, 1)), custom((0x204, 3))
    for model in ("Canon EOS 50D", "Canon EOS REBEL T1i"):
        assert adapted_by(exif_with("Canon", low, model)) == ("Auto Lighting Optimizer (Low)",)
        assert adapted_by(exif_with("Canon", none, model)) == ()
    assert adapted_by(exif_with("Canon", low, "Canon EOS 450D")) == ()


def test_notes_that_a_program_moved_are_read_where_they_say_so() -> None:
    exif = exif_with("Canon", lighting(1, 0), written=footed())
    assert adapted_by(exif) == ("Auto Lighting Optimizer (Low)",)
    assert adapted_by(exif.replace(b"II*\0", b"II*!").replace(b"II*!", b"II*\0", 1)) == ()


def test_all_that_is_on_is_told() -> None:
    tags = {0x69: (BYTES, (1, 2, 0, 0)), 0x79: (BYTES, (1, 3)), 0x85: (BYTES, (2, 1, 8, 0))}
    told = ("Highlight Correction (on)", "Shadow Correction (on)", "HDR (1)")
    assert adapted_by(exif_with("PENTAX", tags)) == told


def test_notes_of_makers_that_are_not_known_say_nothing() -> None:
    exif = exif_with(NIKON, ACTIVE).replace(b"Nikon\0\2", b"Acme!\0\2")
    assert maker_notes(exif).maker == ""
    assert adapted_by(exif) == adapted_by(b"") == adapted_by(b"II*\0") == ()


@settings(max_examples=300, deadline=None)
@given(st.sampled_from(ON), st.data())
def test_damaged_notes_say_less_and_never_fail(
    on: tuple[str, Tags, str], data: st.DataObject
) -> None:
    exif = bytearray(exif_with(on[0], on[1]))
    for _ in range(data.draw(st.integers(1, 8))):
        at = data.draw(st.integers(0, len(exif) - 1))
        exif[at] = data.draw(st.integers(0, 255))
    length = data.draw(st.integers(0, len(exif)))
    for damaged in (bytes(exif), bytes(exif[:length])):
        assert all(isinstance(one, str) for one in adapted_by(damaged))


@settings(max_examples=300, deadline=None)
@given(st.sampled_from([b"", b"II*\0", b"MM\0*", b"Exif\0\0II*\0"]), st.binary(max_size=300))
def test_any_bytes_are_read(begin: bytes, rest: bytes) -> None:
    assert adapted_by(begin + rest) == adapted_by(exif_of(begin + rest, None)) or begin[:1] == b"E"


@settings(max_examples=100, deadline=None)
@given(st.lists(st.integers(-(2**31), 2**31 - 1), max_size=40))
def test_custom_functions_of_any_numbers_come_to_an_end(words: list[int]) -> None:
    adapted_by(exif_with("Canon", {0x99: (SIGNED_LONG, tuple(words))}))


def picture() -> Image.Image:
    return Image.fromarray(np.rint(grace_hopper() * 255).astype(np.uint8))


@pytest.mark.parametrize("suffix", [".jpg", ".png", ".webp", ".tif", ".avif", ".heic"])
def test_every_kind_of_file_is_asked(tmp_path: Path, suffix: str) -> None:
    if suffix == ".heic":
        pytest.importorskip("pillow_heif").register_heif_opener()
    if suffix == ".avif" and not features.check("avif"):
        pytest.skip("this Pillow writes no AVIF")
    exif = exif_with(NIKON, ACTIVE)
    plain, told = tmp_path / f"plain{suffix}", tmp_path / f"a{suffix}"
    try:
        picture().save(plain)
        picture().save(told, exif=(b"Exif\0\0" if suffix == ".jpg" else b"") + exif)
    except (KeyError, RuntimeError):
        pytest.skip("no encoder here")
    if suffix == ".tif":  # whose own directory Pillow writes anew, with the notes as they are
        assert maker_notes(told.read_bytes()).maker == "Nikon"
    assert read_photo(told).adapted == (AUTO,)
    assert read_photo(plain).adapted == ()


def test_exif_in_a_box_of_jpeg_xl_is_found() -> None:
    exif = exif_with(NIKON, ACTIVE)
    box = struct.pack(">I", 12 + len(exif)) + b"Exif" + bytes(4) + exif
    assert adapted_by(exif_of(b"\0\0\0\x0cJXL \r\n\x87\n" + box, None)) == (AUTO,)


def test_of_several_pictures_in_a_jpeg_the_first_tells() -> None:
    """Phones append a second, with EXIF of its own."""
    first, second = (BytesIO() for _ in range(2))
    picture().save(first, "JPEG")
    picture().save(second, "JPEG", exif=exif_with(NIKON, ACTIVE))
    content = first.getvalue() + second.getvalue()
    assert exif_of(content, take_apart(content)) == b""


def test_light_of_a_raw_file_was_not_bent(tmp_path: Path) -> None:
    write_dng(tmp_path / "a.dng", np.full((32, 32), 9000.0))
    assert read_photo(tmp_path / "a.dng").adapted == ()


@pytest.fixture
def bent(tmp_path: Path) -> Photo:
    out = BytesIO()
    picture().save(out, "JPEG", quality=95)
    content = out.getvalue()
    path = tmp_path / "bent.jpg"
    path.write_bytes(content[:2] + app1(exif_with(NIKON, ACTIVE, "NIKON D3100")) + content[2:])
    return read_photo(path)


def test_a_bent_curve_is_told_and_never_reliable(bent: Photo) -> None:
    estimate = calibrate(bent)
    assert estimate.confidence is not None
    assert estimate.confidence.verdict is Verdict.WEAK
    assert estimate.confidence.doubts == (DOUBT,)
    assert f"{DOUBT}; surer: photos with that setting off, or " in sentence(estimate)
    plain = calibrate(bent.but(adapted=()))
    assert plain.confidence is not None
    assert not any("bent it" in doubt for doubt in plain.confidence.doubts)
    assert plain.outcome is estimate.outcome


@pytest.mark.parametrize("estimator", ["face", "rank"])
def test_other_estimators_say_so_once(bent: Photo, estimator: str) -> None:
    confidence = calibrate(bent, estimator=estimator, settings=Settings()).confidence
    assert confidence is not None
    assert [doubt for doubt in confidence.doubts if "bent it" in doubt] == [DOUBT]


def surely(*adapted: str) -> PhotoEvidence:
    """A photo that is very sure of the prior's mean, by a camera that is known."""
    size = shipped_prior().basis.shape[0]
    message = Message(np.zeros(size), np.full(size, 1e4))
    covered = np.full((3, 64), 1.0 / 64.0)
    camera = ("NIKON CORPORATION", "NIKON D7000")
    return PhotoEvidence({"noise": message}, covered, camera=camera, adapted=adapted)


def test_no_evidence_and_no_measurement_makes_a_bent_curve_reliable() -> None:
    plain, told = (conclude([surely(*adapted)]).confidence for adapted in ((), (AUTO,)))
    assert plain is not None
    assert told is not None
    assert told.verdict is Verdict.WEAK
    assert DOUBT in told.doubts
    without = conclude([surely()], cameras=()).confidence
    assert without is not None
    assert without.verdict is Verdict.RELIABLE


def test_photos_together_say_once_what_bent_them() -> None:
    seen = [surely(AUTO), surely(AUTO), surely("HDR (on)"), surely()]
    confidence = conclude(seen, cameras=()).confidence
    assert confidence is not None
    assert confidence.verdict is Verdict.WEAK
    assert confidence.doubts == (DOUBT.replace(AUTO, f"{AUTO}, HDR (on)"),)


def test_photos_given_together_are_asked(bent: Photo) -> None:
    confidence = calibrate_together([bent]).estimate.confidence
    assert confidence is not None
    assert DOUBT in confidence.doubts


def test_a_measured_curve_counts_as_another_model_s_where_it_was_bent() -> None:
    camera, prior = ("NIKON CORPORATION", "NIKON D7000"), shipped_prior()
    plain, told = (
        known_response(shipped_cameras(), *camera, prior, bent=bent) for bent in (False, True)
    )
    assert plain is not None
    assert told is not None
    assert np.array_equal(plain.message.mean, told.message.mean)
    spreads = (1 / one.message.precision[:3] ** 0.5 for one in (plain, told))
    for spread, least in zip(spreads, (STYLES, OTHER_MODELS), strict=True):
        assert (spread > least).all()
        assert (spread < np.array(least) + 0.1).all()
    reasons = conclude([surely(AUTO)]).confidence.reasons  # type: ignore[union-attr]
    assert any("D7000 counts as another model's would" in one for one in reasons)


def test_a_chart_on_which_the_curve_was_bent_measures_no_camera() -> None:
    light, corners = lit_chart(3, white=0.75)
    photo = shot(light, gamma_curve(2.2), quality=95)[1]
    plain, told = (
        calibrate_chart(photo.but(adapted=adapted), corners).estimate for adapted in ((), (AUTO,))
    )
    assert plain.confidence is not None
    assert told.confidence is not None
    assert np.array_equal(plain.curve.linear, told.curve.linear)
    assert told.confidence.doubts == (DOUBT,)
    assert sentence(told).endswith(f"{DOUBT}; surer: photos with that setting off")
    assert (plain.confidence.verdict, told.confidence.verdict) == (Verdict.RELIABLE, Verdict.WEAK)
    camera = Camera("Acme", "One")
    kept = [
        entry(camera, estimate, "a chart", style=", ".join(adapted))
        for estimate, adapted in ((plain, ()), (told, (AUTO,)))
    ]
    assert [(one.grade, one.style) for one in kept] == [("B", ""), ("C", AUTO)]
    alone, both = (
        known_response(listed, "Acme", "One", shipped_prior()) for listed in (kept[1:], kept)
    )
    assert alone is not None
    assert both is not None
    assert (alone.bent, both.bent) == (True, False)
    assert (alone.message.precision[:2] < both.message.precision[:2] / 2).all()


def test_a_record_tells_a_registry_what_bent_a_measurement(bent: Photo, tmp_path: Path) -> None:
    """But of a bracket, whose exposures would not agree if they were bent."""
    for way, style in (("pair", AUTO), ("chart", AUTO), ("bracket", "")):
        estimate = replace(calibrate(bent, estimator="mean"), estimator=way)
        record = Record(source_of(bent), estimate, {}, {}, ())
        assert from_record(tmp_path / "a.crf.json", record).style == style


def test_real_notes_of_makers_are_read(development_data: Path) -> None:
    """By cameras older than such settings, or with nothing on."""
    makers = {}
    for path in sorted((development_data / "faces" / "camera_jpeg").glob("*.jpg")):
        content = path.read_bytes()
        exif = exif_of(content, take_apart(content))
        makers[path.stem] = maker_notes(exif).maker
        assert adapted_by(exif) == ()
    assert makers["Canon_PowerShot_A560"] == "Canon"
    assert makers["FujiFilm_FinePix2650"] == "Fujifilm"


def test_evidence_and_records_keep_it(bent: Photo) -> None:
    evidence = surely(AUTO)
    assert PhotoEvidence.from_json(evidence.to_json()).adapted == (AUTO,)
    old = json.loads(evidence.to_json())
    del old["adapted"]
    assert PhotoEvidence.from_json(json.dumps(old)).adapted == ()
    assert source_of(bent).adapted == (AUTO,)
    told = {
        "primaries": None,
        "camera": {"make": "", "model": "", "serial": "", "software": ""},
        **{name: getattr(source_of(bent), name) for name in ("name", "sha256", "width", "height")},
        "bit_depth": 8,
        "scene_linear": False,
        "grayscale": False,
    }
    assert source_in(told).adapted == ()
    assert source_in({**told, "adapted": [AUTO]}).adapted == (AUTO,)


def test_a_photo_keeps_it_through_changes(bent: Photo) -> None:
    assert bent.but(notes=("cropped",)).adapted == (AUTO,)
    assert replace(surely(AUTO), leaning=0.0).adapted == (AUTO,)
