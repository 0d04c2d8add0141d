"""Errors by percentile and by group, and how often a verdict is borne out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from facecrf_ocio.benchmark.groups import (
    PERCENTILES,
    groups_markdown,
    image_groups,
    percentiles_markdown,
)
from facecrf_ocio.benchmark.tables import is_right, summarize
from facecrf_ocio.benchmark.workbench import CaseResult
from facecrf_ocio.errors import PhotoError

ONE = CaseResult("paper", "joint", "a.exr", 0, "row 0", "Nikon", "camera_jpeg", None, "calibrated",
             "reliable", True, "", 0.05, 0.1, None, 0.0, 0.01, 0.01, 0.01, 0.01, 0.0, 0.9, 0.8,
             None, None, 0.1)  # fmt: skip


def results_with(estimator, errors, verdict="reliable", **changes):
    return [
        replace(
            ONE, estimator=estimator, row=row, mid=error, rmse=error, verdict=verdict, **changes
        )
        for row, error in enumerate(errors)
    ]


def lines_of(table):
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]


class TestPercentiles:
    def test_they_are_those_of_numpy_in_stops_first_and_rmse_times_a_hundred(self):
        errors = np.random.default_rng(0).uniform(0.0, 0.3, 57)
        lines = lines_of(percentiles_markdown(results_with("joint", errors)))
        for row, factor in ((lines[2], 1.0), (lines[6], 100.0)):
            assert row[:2] == ["joint", "paper"]
            expected = factor * np.percentile(errors, PERCENTILES)
            assert [float(cell) for cell in row[2:]] == pytest.approx(expected, abs=0.006)

    def test_every_estimator_of_every_protocol_has_a_row(self):
        results = results_with("joint", [0.1]) + results_with("mean", [0.2], protocol="held-out")
        assert [r[:2] for r in lines_of(percentiles_markdown(results))[2:4]] == [
            ["joint", "paper"],
            ["mean", "held-out"],
        ]


class TestGroups:
    def test_each_group_has_its_own_errors_beside_the_fixed_answers(self):
        results = [
            *results_with("joint", [0.01, 0.03]),
            *results_with("joint", [0.20], kind="webcam"),
            *results_with("srgb", [0.10, 0.10]),
            *results_with("identity", [0.50]),
        ]
        table = lines_of(groups_markdown(results, "kind", lambda result: result.kind))
        assert [[line[0], *line[2:7], *line[9:12]] for line in table[2:]] == [
            ["camera_jpeg", "joint", "2", "0.020", "0.020", "0.030", "2.00", "2.00", "3.00"],
            ["camera_jpeg", "srgb", "2", "0.100", "0.100", "0.100", "10.00", "10.00", "10.00"],
            ["webcam", "joint", "1", "0.200", "0.200", "0.200", "20.00", "20.00", "20.00"],
        ]

    def test_what_has_no_group_is_left_out(self):
        nameless = results_with("joint", [0.1], kind="")
        assert groups_markdown(nameless, "kind", lambda result: result.kind) == ""

    def test_any_column_may_hold_the_names(self, tmp_path):
        table = tmp_path / "index.tsv"
        table.write_text("clean\tnoisy\ttone\nimg/a_clean.exr\timg/a_noisy.exr\tdark\n", "utf-8")
        groups = image_groups(table, "tone")
        assert groups["a_clean.exr"] == groups["a_noisy.exr"] == "dark"

    def test_a_column_that_is_not_there_is_told_with_those_that_are(self, tmp_path):
        table = tmp_path / "index.tsv"
        table.write_text("clean\tnoisy\na.exr\tb.exr\n", "utf-8")
        with pytest.raises(PhotoError, match="no column tone; name one of its columns: clean, noi"):
            image_groups(table, "tone")


class TestVerdicts:
    def test_those_called_reliable_are_held_against_the_truth_and_srgb_on_the_same_photo(self):
        results = [
            *results_with("joint", [0.01, 0.10, 0.12, 0.16]),
            *results_with("joint", [0.20, 0.30], verdict="weak", image="b.exr"),
            *results_with("srgb", [0.02, 0.08, 0.14, 0.30], verdict=""),
        ]
        joint, srgb = summarize(results)
        assert joint.reliable == pytest.approx(4 / 6)
        # 0.10 is farther than sRGB, and 0.16 too far from the truth.
        assert joint.reliable_right == 0.5
        assert joint.nearer_than_srgb == 0.75
        assert srgb.reliable == 0.0
        assert srgb.reliable_right is None

    def test_an_estimate_of_an_srgb_photo_may_be_reliable(self):
        assert is_right(0.04, srgb_mid=0.0)
        assert not is_right(0.06, srgb_mid=0.0)
        assert is_right(0.15, srgb_mid=0.2)
        assert not is_right(0.16, srgb_mid=0.2)
