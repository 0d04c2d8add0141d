"""`facecrf bench consistency`: tests of estimates that need no truth."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from click.testing import CliRunner
from photo_files import write

from facecrf_ocio.benchmark import consistency
from facecrf_ocio.benchmark.consistency import (
    AGREEMENT,
    EQUIVARIANCE,
    SRGB,
    consistency_markdown,
    known_curves,
    measure_consistency,
)
from facecrf_ocio.cli.bench_command import bench
from facecrf_ocio.values import Camera, Confidence, Estimate, InverseCRF, Outcome, Photo, Verdict

FINE = np.linspace(0.0, 1.0, 4096)
CANON = Camera("Canon", "EOS 5D")


def curve_of(exponent):
    return InverseCRF(FINE, np.tile(FINE**exponent, (3, 1)))


def estimated(exponent):
    wide = Confidence(np.full((3, 4096), 0.1), np.ones((3, 4096)), Verdict.WEAK, ())
    return Estimate(Outcome.CALIBRATED, "joint", "", found=curve_of(exponent), confidence=wide)


def oracle(photo):
    """Knows that the top row of every photo holds linear light of a hundredth to one."""
    light = np.linspace(0.01, 1.0, photo.encoded.shape[1])
    codes = photo.encoded[0, :, 0]
    given, where = np.unique(codes, return_index=True)
    curve = np.interp(FINE, np.concatenate([[0.0], given, [1.0 + 1e-9]]),
                      np.concatenate([[0.0], light[where], [1.0]]))  # fmt: skip
    curve = np.maximum.accumulate(curve) + 1e-9 * FINE
    curve = (curve - curve[0]) / (curve[-1] - curve[0])
    return replace(estimated(1.0), found=InverseCRF(FINE, np.tile(curve, (3, 1))))


def photo_files(tmp_path, exponents):
    """Photos of a ramp of light, through gamma curves."""
    light = np.tile(np.linspace(0.01, 1.0, 2000)[None, :, None], (4, 1, 3))
    paths = []
    for number, exponent in enumerate(exponents):
        codes = np.rint(light ** (1 / exponent) * 65535).astype(np.uint16)
        paths.append(write(tmp_path / f"{number}.tif", codes, oiio.UINT16))
    return paths


def test_known_curves_rise_from_black_to_white():
    curves = known_curves()
    assert len(curves) == 6
    for curve in curves.values():
        assert (curve[0], curve[-1]) == pytest.approx((0.0, 1.0))
        assert (np.diff(curve) > 0).all()


def test_who_knows_the_truth_is_consistent(tmp_path, monkeypatch):
    monkeypatch.setattr(consistency, "calibrate", oracle)
    found = measure_consistency(photo_files(tmp_path, [2.2, 1.8]))
    assert len([d for d in found.differences if d.test == EQUIVARIANCE]) == 12
    assert len([d for d in found.differences if d.test == SRGB]) == 2
    assert max(d.mid for d in found.differences) < 0.04
    assert max(d.rmse for d in found.differences) < 0.01


def test_who_always_answers_the_same_is_found_out(tmp_path, monkeypatch):
    monkeypatch.setattr(consistency, "calibrate", lambda _: estimated(2.2))
    found = measure_consistency(photo_files(tmp_path, [2.2]))
    by_curve = {d.curve: d.mid for d in found.differences if d.test == EQUIVARIANCE}
    # g stays x^2.2 where x^(2.2 / p) is right.
    codes = np.arange(64, 236)
    for power in (0.75, 1.33):
        expected = abs(2.2 - 2.2 / power) * np.abs(np.log2(codes / 128)).mean()
        assert by_curve[f"power {power:g}"] == pytest.approx(expected, rel=0.02)


def test_no_curve_can_be_read_from_codes_that_it_left_out(tmp_path, monkeypatch):
    seen = []

    def watched(photo):
        seen.append(np.rint(255.0 * photo.encoded[..., 0]).astype(int))
        return estimated(2.2)

    monkeypatch.setattr(consistency, "calibrate", watched)
    codes = np.tile(np.arange(256, dtype=np.uint8)[None, :, None], (64, 4, 3))
    measure_consistency([write(tmp_path / "ramp.png", codes, oiio.UINT8)])
    assert len(seen) == 1 + 6 + 1  # as it is, through six curves, and encoded as sRGB
    for changed in seen:
        assert set(range(255)) - set(changed.ravel().tolist()) == set()


def test_photos_of_one_camera_are_held_against_their_others(tmp_path, monkeypatch):
    answers = iter([2.0, 2.4, 2.2, 3.0])
    cameras = iter([CANON, CANON, Camera(), Camera("Sony", "A")])
    monkeypatch.setattr(consistency, "calibrate", lambda _: estimated(next(answers)))
    monkeypatch.setattr(consistency, "_through_curves", lambda *_: ())
    monkeypatch.setattr(consistency, "_as_srgb", lambda *_: ())
    monkeypatch.setattr(
        consistency,
        "read_photo",
        lambda _: Photo(np.full((4, 4, 3), 0.5, np.float32), 8, camera=next(cameras)),
    )
    paths = photo_files(tmp_path, [2.2] * 4)
    found = measure_consistency(paths).differences
    assert [(d.test, d.photo, d.curve) for d in found] == [
        (AGREEMENT, "0.tif", "Canon EOS 5D"),
        (AGREEMENT, "1.tif", "Canon EOS 5D"),
    ]
    expected = 0.4 * np.abs(np.log2(np.arange(64, 236) / 128)).mean()
    assert found[0].mid == pytest.approx(expected, rel=0.01)


def test_the_table_has_a_row_for_each_test():
    differences = tuple(
        consistency.Difference(EQUIVARIANCE, "a", "h", mid, 2 * mid, mid / 2, None)
        for mid in np.linspace(0.0, 0.2, 21)
    )
    text = consistency_markdown(consistency.Consistency(differences, ()))
    row = [cell.strip() for cell in text.splitlines()[2].strip("|").split("|")]
    assert row == [EQUIVARIANCE, "21", "0.100", "0.100", "0.190", "0.200", "0.380", "5.00",
                   "5.00", "9.50", "-"]  # fmt: skip


def test_photos_without_an_estimate_are_told_and_nothing_is_written_of_them(tmp_path):
    gray = write(tmp_path / "gray.png", np.full((60, 60, 3), 90, np.uint8), oiio.UINT8)
    given = ["consistency", str(gray), str(tmp_path / "missing.jpg"), "-o", str(tmp_path / "out")]
    result = CliRunner().invoke(bench, given)
    assert result.exit_code == 0, result.output
    assert "No photo to test." in result.output
    assert "left out:" in result.output
    record = json.loads((tmp_path / "out" / "consistency.json").read_text("utf-8"))
    assert record["cases"] == []
    assert len(record["run"]["left_out"]) == 2
