"""The record says all there is to say, in JSON that any reader accepts."""

from __future__ import annotations

import json
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from facecrf_ocio.errors import LutError, OutputError
from facecrf_ocio.files import strict_json
from facecrf_ocio.record.calibration_record import read_record, write_record
from facecrf_ocio.record.sampled import TOLERANCE, read_rows, thinned
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import (
    Camera,
    Confidence,
    Estimate,
    Face,
    InStops,
    InverseCRF,
    Outcome,
    Photo,
    Primaries,
    Verdict,
)

CODES = np.linspace(0.0, 1.0, 256)
REC709 = Primaries("Rec.709", (0.64, 0.33), (0.3, 0.6), (0.15, 0.06), (0.3127, 0.329), "assumed")


def photo(name: str = "a.jpg", **changes: Any) -> Photo:
    known = Photo(
        np.zeros((20, 30, 3), np.float32),
        bit_depth=8,
        primaries=REC709,
        camera=Camera("Nikon", "D800", "42", "Ver. 1.0"),
        path=Path("somewhere") / name,
        sha256="ab" * 32,
    )
    return replace(known, **changes)


def estimate(**changes: Any) -> Estimate:
    rng = np.random.default_rng(1)
    known = Estimate(
        outcome=Outcome.CALIBRATED,
        estimator="face",
        reason="1 face gave 123 pairs",
        found=InverseCRF(CODES, np.stack([CODES**2.2, CODES**2.4, CODES ** (1 / 3)])),
        confidence=Confidence(
            rng.random((3, 256)), rng.random((3, 256)), Verdict.WEAK, ("few pairs", "dark")
        ),
        coefficients=rng.normal(size=(3, 5)),
        energy={"E_p": 1.5, "E_G": -2.0, "E_m": 0.0},
        faces=(Face(np.array([1.5, 2.0, 100.0, 120.0]), np.zeros((478, 3)), 0.875),),
        assumptions=("primaries are those of Rec.709", "exposure is known up to a factor"),
    )
    if "found" in changes and "confidence" not in changes:
        count = changes["found"].encoded.size
        changes["confidence"] = Confidence(
            rng.random((3, count)), rng.random((3, count)), Verdict.WEAK, ()
        )
    return replace(known, **changes)


def not_calibrated() -> Estimate:
    return Estimate(Outcome.NOT_CALIBRATED, "face", "no face was found", "give a photo with a face")


def refuse(constant: str) -> None:
    pytest.fail(f"{constant} is not JSON")


def test_the_curve_comes_back_to_the_last_digit(tmp_path: Path) -> None:
    given_estimate = estimate()
    back = read_record(write_record(tmp_path / "a.crf.json", photo(), given_estimate, Settings()))
    assert back.estimate.found is not None
    np.testing.assert_array_equal(back.estimate.found.encoded, given_estimate.curve.encoded)
    np.testing.assert_array_equal(back.estimate.found.linear, given_estimate.curve.linear)
    np.testing.assert_array_equal(back.estimate.coefficients, given_estimate.coefficients)


@hypothesis_settings(max_examples=20, deadline=None)
@given(inner=st.lists(st.floats(1e-300, 1 - 1e-9), min_size=1, max_size=30, unique=True))
def test_any_curve_comes_back_to_the_last_digit(
    inner: list[float], tmp_path_factory: pytest.TempPathFactory
) -> None:
    samples = np.array([0.0, *sorted(inner), 1.0])
    curve = InverseCRF(samples, np.stack([samples] * 3))
    path = tmp_path_factory.mktemp("record") / "a.crf.json"
    written = write_record(path, photo(), estimate(found=curve), Settings())
    back = read_record(written).estimate.found
    assert back is not None
    np.testing.assert_array_equal(back.encoded, samples)
    np.testing.assert_array_equal(back.linear, curve.linear)


def test_everything_else_comes_back_too(tmp_path: Path) -> None:
    settings = Settings(shared_curve=True, face_width=200)
    path = write_record(
        tmp_path / "a.crf.json", photo(), estimate(), settings, luts=[tmp_path / "a.spi1d"]
    )
    back = read_record(path)
    assert (back.estimate.outcome, back.estimate.estimator) == (Outcome.CALIBRATED, "face")
    assert (back.estimate.reason, back.estimate.remedy) == ("1 face gave 123 pairs", "")
    assert back.estimate.energy == {"E_p": 1.5, "E_G": -2.0, "E_m": 0.0}
    assert [(*face.box_xy, face.score) for face in back.estimate.faces] == [
        (1.5, 2, 100, 120, 0.875)
    ]
    assert back.estimate.assumptions == estimate().assumptions
    assert Settings(**back.settings) == settings  # type: ignore[arg-type]
    assert back.luts == ("a.spi1d",)
    source = back.source
    assert (source.name, source.sha256) == ("a.jpg", "ab" * 32)
    assert (source.width, source.height, source.bit_depth) == (30, 20, 8)
    assert (source.camera, source.primaries) == (photo().camera, REC709)


def test_confidence_comes_back_to_six_digits(tmp_path: Path) -> None:
    path = write_record(tmp_path / "a.crf.json", photo(), estimate(), Settings())
    back, known = read_record(path).estimate.confidence, estimate().confidence
    assert back is not None
    assert known is not None
    assert (back.verdict, back.reasons) == (Verdict.WEAK, ("few pairs", "dark"))
    np.testing.assert_allclose(back.sigma, known.sigma, rtol=1e-5)
    np.testing.assert_allclose(back.coverage, known.coverage, rtol=1e-5)


def old_record(path: Path, given_estimate: Estimate) -> Path:
    """A record as the first version wrote it: all numbers, of all channels."""
    path = write_record(path, photo(), given_estimate, Settings())
    record = json.loads(path.read_text("utf-8"))
    curve, told = given_estimate.curve, given_estimate.confidence
    assert told is not None
    record["schema_version"] = 1
    record["curve"] = {"encoded": curve.encoded.tolist(), "linear": curve.linear.tolist()}
    record["confidence"].update(sigma=told.sigma.tolist(), coverage=told.coverage.tolist())
    path.write_text(json.dumps(record), "utf-8")
    return path


def smooth_estimate() -> Estimate:
    """One curve for all channels at 4096 codes, as the estimators give them."""
    codes = np.linspace(0.0, 1.0, 4096)
    sigma = 0.05 * np.sin(np.pi * codes) + 0.01 * codes * (1 - codes)
    triangle = np.interp(codes, [0, 0.3, 0.31, 1], [0, 1, 0.2, 0.25])
    confidence = Confidence(
        np.tile(sigma, (3, 1)), np.stack([triangle, triangle**2, codes]), Verdict.WEAK, ()
    )
    linear = np.tile(codes**2.2 / (codes**2.2)[-1], (3, 1))
    return estimate(found=InverseCRF(codes, linear), confidence=confidence)


def test_what_is_told_in_stops_comes_back(tmp_path: Path) -> None:
    sigma = np.tile(np.abs(np.linspace(-0.4, 0.3, 256)), (3, 1))
    known = smooth_estimate()
    assert known.confidence is not None
    told = replace(
        known.confidence,
        in_stops=InStops(sigma, 0.0842, 0.213),
        nearer_than_srgb=0.97,
        outvoted=("grain",),
    )
    path = tmp_path / "a.crf.json"
    write_record(path, photo(), replace(known, confidence=told), Settings())
    back = read_record(path).estimate.confidence
    assert back is not None
    assert back.in_stops is not None
    assert (back.in_stops.mid, back.in_stops.shadows) == (0.0842, 0.213)
    assert np.abs(back.in_stops.sigma - sigma).max() <= 1e-5
    assert (back.nearer_than_srgb, back.outvoted) == (0.97, ("grain",))
    assert json.loads(path.read_text("utf-8"))["confidence"]["differs_from_srgb"] is True


def test_a_record_from_before_stops_were_told_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.crf.json"
    write_record(path, photo(), smooth_estimate(), Settings())
    record = json.loads(path.read_text("utf-8"))
    for name in ("expected_stops", "sigma_stops", "nearer_than_srgb", "differs_from_srgb"):
        del record["confidence"][name]
    del record["confidence"]["outvoted"]
    path.write_text(json.dumps(record), "utf-8")
    back = read_record(path).estimate.confidence
    assert back is not None
    assert (back.in_stops, back.nearer_than_srgb, back.outvoted) == (None, None, ())


@pytest.mark.parametrize("given_estimate", [estimate(), smooth_estimate()])
def test_a_record_of_the_first_version_is_read(given_estimate: Estimate, tmp_path: Path) -> None:
    back = read_record(old_record(tmp_path / "a.crf.json", given_estimate))
    assert back.estimate.found is not None
    assert back.estimate.confidence is not None
    assert given_estimate.confidence is not None
    np.testing.assert_array_equal(back.estimate.found.encoded, given_estimate.curve.encoded)
    np.testing.assert_array_equal(back.estimate.found.linear, given_estimate.curve.linear)
    np.testing.assert_array_equal(back.estimate.confidence.sigma, given_estimate.confidence.sigma)
    np.testing.assert_array_equal(
        back.estimate.confidence.coverage, given_estimate.confidence.coverage
    )


def test_a_curve_is_written_once_and_smooth_bands_thinned(tmp_path: Path) -> None:
    given_estimate = smooth_estimate()
    told = given_estimate.confidence
    assert told is not None
    path = write_record(tmp_path / "a.crf.json", photo(), given_estimate, Settings())
    assert path.stat().st_size < 100_000
    back = read_record(path)
    assert back.estimate.found is not None
    assert back.estimate.confidence is not None
    np.testing.assert_array_equal(back.estimate.found.encoded, given_estimate.curve.encoded)
    np.testing.assert_array_equal(back.estimate.found.linear, given_estimate.curve.linear)
    assert np.abs(back.estimate.confidence.sigma - told.sigma).max() <= 1e-5
    assert np.abs(back.estimate.confidence.coverage - told.coverage).max() <= 1e-5


@hypothesis_settings(max_examples=100, deadline=None)
@given(
    rows=arrays(np.float64, st.tuples(st.just(3), st.integers(1, 60)), elements=st.floats(0.0, 1.0))
)
def test_thinned_numbers_come_back_within_their_tolerance(rows: np.ndarray) -> None:
    record = json.loads(json.dumps(thinned(rows)))
    np.testing.assert_allclose(read_rows(record), rows, rtol=1e-5, atol=TOLERANCE)


@hypothesis_settings(max_examples=50, deadline=None)
@given(
    nodes=st.lists(st.floats(0.0, 1.0), min_size=2, max_size=60),
    bend=st.floats(0.0, 3.0),
)
@example(nodes=[0.25, 0.5, 0, 0, 0, 1, 0.25, 0, 0.671875, 0.25], bend=2.875)
def test_what_was_read_back_is_written_the_same_again(nodes: list[float], bend: float) -> None:
    places = np.linspace(0.0, 1.0, 4096)
    row = np.interp(places, np.linspace(0.0, 1.0, len(nodes)), nodes) ** (1.0 + bend)
    once = thinned(row[None])
    assert thinned(read_rows(once)) == once


@pytest.mark.parametrize("at", [[], [1, 3], [0, 3, 2], [0, 0, 3], [0, None], "ab"])
def test_thinned_numbers_out_of_order_are_no_record(at: object, tmp_path: Path) -> None:
    path = write_record(tmp_path / "a.crf.json", photo(), estimate(), Settings())
    confidence = json.loads(path.read_text("utf-8"))["confidence"]
    odd = {**confidence, "sigma": [{"at": at, "is": [0.1, 0.2, 0.3]}]}
    with pytest.raises(LutError, match=r"a\.crf\.json: is no record of facecrf"):
        read_record(damaged(path, confidence=odd))


def test_versions_of_what_made_it_are_told(tmp_path: Path) -> None:
    path = write_record(tmp_path / "a.crf.json", photo(), estimate(), Settings())
    versions = read_record(path).versions
    assert versions["numpy"] == np.__version__
    assert {"facecrf_ocio", "python", "OpenColorIO", "OpenImageIO", "scipy", "OpenCV"} <= set(
        versions
    )


def test_a_photo_that_could_not_be_calibrated_has_a_record_too(tmp_path: Path) -> None:
    path = write_record(tmp_path / "a.crf.json", photo(), not_calibrated(), Settings())
    back = read_record(path)
    assert (back.estimate.outcome, back.estimate.found) == (Outcome.NOT_CALIBRATED, None)
    assert (back.estimate.confidence, back.estimate.coefficients, back.estimate.faces) == (
        None,
        None,
        (),
    )
    assert (back.estimate.reason, back.estimate.remedy) == (
        "no face was found",
        "give a photo with a face",
    )


def test_a_photo_in_memory_has_one_too(tmp_path: Path) -> None:
    bare = Photo(np.zeros((2, 3, 3), np.float32))
    back = read_record(write_record(tmp_path / "a.crf.json", bare, estimate(), Settings()))
    assert (back.source.name, back.source.sha256, back.source.primaries) == (None, None, None)


def test_every_field_of_photo_estimate_and_settings_is_told(tmp_path: Path) -> None:
    path = write_record(tmp_path / "a.crf.json", photo(), estimate(), Settings())
    record = json.loads(path.read_text("utf-8"))
    assert record["settings"] == asdict(Settings())
    renamed = {"found": "curve"}
    assert {renamed.get(f.name, f.name) for f in fields(Estimate)} <= set(record)
    untold = {"encoded", "codes", "alpha"}  # pixels
    renamed = {"path": "name"}
    told = set(record["source"])
    assert {renamed.get(f.name, f.name) for f in fields(Photo)} - untold <= told


def test_the_file_is_strict_json_even_where_numbers_are_not_finite(tmp_path: Path) -> None:
    confidence = Confidence(
        np.full((3, 256), np.nan), np.full((3, 256), np.inf), Verdict.PRIOR_ONLY, ()
    )
    odd = estimate(energy={"E_p": np.float64("nan"), "E_m": np.float32(2)}, confidence=confidence)
    path = write_record(tmp_path / "a.crf.json", photo(), odd, Settings())
    record = json.loads(path.read_bytes().decode("utf-8"), parse_constant=refuse)
    assert record["energy"] == {"E_p": None, "E_m": 2.0}
    back = read_record(path)
    assert np.isnan(back.estimate.energy["E_p"])
    assert back.estimate.confidence is not None
    assert np.isnan(back.estimate.confidence.sigma).all()


@pytest.mark.parametrize("name", ["Zoë 日本 🙂.jpg", 'a "b" $c\\d\n\x01.jpg', "bytes \udcff.jpg"])
def test_any_name_of_a_photo_comes_back(name: str, tmp_path: Path) -> None:
    path = write_record(tmp_path / "a.crf.json", photo(name), estimate(), Settings())
    assert read_record(path).source.name == name
    json.loads(path.read_bytes().decode("utf-8"), parse_constant=refuse)


def test_an_existing_record_stays_unless_overwriting_is_asked_for(tmp_path: Path) -> None:
    path = write_record(tmp_path / "a.crf.json", photo(), not_calibrated(), Settings())
    with pytest.raises(OutputError, match=r"a\.crf\.json: exists already; pass overwrite=True"):
        write_record(path, photo(), estimate(), Settings())
    assert read_record(path).estimate.found is None
    write_record(path, photo(), estimate(), Settings(), overwrite=True)
    assert read_record(path).estimate.found is not None


def damaged(path: Path, **changes: Any) -> Path:
    record = json.loads(path.read_text("utf-8"))
    path.write_text(json.dumps({**record, **changes}))
    return path


BAD_RECORDS: dict[str, dict[str, Any]] = {
    "another schema": {"schema": "other"},
    "a falling curve": {"curve": {"encoded": [0, 0.5, 1], "linear": [[0, 2, 1]] * 3}},
    "a curve with a hole": {"curve": {"encoded": [0, None, 1], "linear": [[0, 0.5, 1]] * 3}},
    "a curve of text": {"curve": {"encoded": "abc", "linear": [[0, 1]] * 3}},
    "an unknown outcome": {"outcome": "splendid"},
    "a list for a mapping": {"energy": [1, 2]},
    "no source": {"source": None},
    "NaN": {"energy": {"E_p": float("nan")}},
}


@pytest.mark.parametrize("name", BAD_RECORDS)
def test_a_changed_record_is_told_in_one_line(name: str, tmp_path: Path) -> None:
    path = write_record(tmp_path / "a.crf.json", photo(), estimate(), Settings())
    with pytest.raises(LutError, match=r"a\.crf\.json: is no record of facecrf") as caught:
        read_record(damaged(path, **BAD_RECORDS[name]))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "content", [b"", b"{", b"[]", b"null", b"\xff\xfe", b"{}", b"[" * 100000, b'{"schema": 1}']
)
def test_other_files_are_told_in_one_line(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.crf.json"
    path.write_bytes(content)
    with pytest.raises(LutError, match=r"a\.crf\.json: is no record of facecrf") as caught:
        read_record(path)
    assert "\n" not in str(caught.value)


def test_a_newer_record_asks_for_an_update(tmp_path: Path) -> None:
    path = write_record(tmp_path / "a.crf.json", photo(), estimate(), Settings())
    with pytest.raises(LutError, match="was written by a newer facecrf; update"):
        read_record(damaged(path, schema_version=3))


def test_a_missing_record_is_told(tmp_path: Path) -> None:
    with pytest.raises(LutError, match=r"a\.crf\.json: cannot be read: no such file"):
        read_record(tmp_path / "a.crf.json")


@pytest.mark.parametrize(
    "absurd",
    [
        {"curve": {"encoded": {"uniform": 10**15}, "linear": [{"at": [0, 1], "is": [0, 1]}]}},
        {"curve": {"encoded": {"uniform": 2}, "linear": [{"at": [0, 10**12], "is": [0, 1]}]}},
        {"coefficients": [[10**400]]},
        {"energy": {"E_p": 10**400}},
        {"luts": ["../../a.spi1d"]},
        {"luts": ["/etc/passwd"]},
        {"faces": [{"box_xy": "abcd", "score": 1}]},
    ],
)
def test_absurd_numbers_and_names_are_refused_at_once(tmp_path: Path, absurd: Any) -> None:
    path = write_record(tmp_path / "a.crf.json", photo(), estimate(), Settings())
    with pytest.raises(LutError, match="is no record of facecrf, or was changed"):
        read_record(damaged(path, **absurd))


def test_a_number_beyond_what_floats_hold_and_a_huge_file_are_refused(tmp_path: Path) -> None:
    path = write_record(tmp_path / "a.crf.json", photo(), estimate(), Settings())
    content = path.read_bytes()
    path.write_bytes(content.replace(b'"score": 0.875', b'"score": 1e999'))
    with pytest.raises(LutError, match="more than a number can hold"):
        read_record(path)
    with path.open("wb") as file:
        file.truncate(1 << 40)  # a terabyte of nothing
    with pytest.raises(LutError, match="more than 32 MB"):
        read_record(path)


@pytest.mark.parametrize("number", [b"1e999", b"-2.5E+400", b"1" + 400 * b"0" + b".0"])
@pytest.mark.parametrize("after", [b"]", b", 1]", b"\n]", b"e", b""])
def test_numbers_are_refused_wherever_they_stand(number: bytes, after: bytes) -> None:
    content = number if not after else b"[" + number + after
    with pytest.raises(ValueError, match=r"more than a number can hold|Extra data|delimiter"):
        strict_json.load(content)


def test_a_hash_is_no_number() -> None:
    assert strict_json.load(b'{"sha256": "1e400"}') == {"sha256": "1e400"}
