"""The registry of measured responses: what ships, what users add, and what is no measurement."""

from __future__ import annotations

import json
from dataclasses import asdict

import numpy as np
import pytest
from command_line import CommandLine

from facecrf_ocio.cameras.known_cameras import (
    FORMAT,
    KnownCamera,
    matching,
    names_of,
    read_registry,
    shipped_cameras,
    write_registry,
)
from facecrf_ocio.cameras.maker_names import camera_name, one_spelling
from facecrf_ocio.record.outputs import write_outputs
from facecrf_ocio.settings import Settings
from facecrf_ocio.synthetic import gamma_curve
from facecrf_ocio.values import Camera, Confidence, Estimate, Outcome, Photo, Verdict


@pytest.fixture
def registry(monkeypatch, tmp_path):
    path = tmp_path / "data" / "cameras.json"
    monkeypatch.setenv("FACECRF_CAMERAS", str(path))
    return path


def record(folder, estimator="bracket", model="One"):
    curve = gamma_curve(2.2)
    confidence = Confidence(
        0.02 * curve.linear, np.ones_like(curve.linear), Verdict.RELIABLE, ("measured",)
    )
    estimate = Estimate(
        Outcome.CALIBRATED, estimator, "by hand", found=curve, confidence=confidence
    )
    photo = Photo(
        np.zeros((4, 4, 3), np.float32),
        camera=Camera("Acme", model),
        path=folder / "a.jpg",
        sha256="0" * 64,
    )
    return write_outputs(photo, estimate, Settings(), folder, ("spi1d",))[-1]


def test_those_that_ship_are_curves_with_proof():
    ways = {"bracket": "exposure stacks ", "chart": "photos of a chart "}
    for one in shipped_cameras():
        assert one.curve.linear.shape == (3, 4096)
        assert one.grade in "ABC"
        assert one.spread_stops >= 0.06
        assert one.proof.startswith(ways[one.method])
    methods = [one.method for one in shipped_cameras()]
    assert (methods.count("bracket"), methods.count("chart")) == (20, 30)


def test_those_that_ship_say_what_bent_the_curve_while_they_were_measured():
    """It weighs where photos of the chart show it; the others' makers' notes have nothing on."""
    on = {
        one.model: (one.style or one.proof.rpartition(", with ")[2], bool(one.style))
        for one in shipped_cameras()
        if one.style or ", with " in one.proof
    }
    assert on == {
        "NIKON D3100": ("Active D-Lighting (Auto)", True),
        "NIKON D3300": ("Active D-Lighting (Auto)", False),
        "Canon EOS 550D": ("Auto Lighting Optimizer (Standard)", False),
        "Canon EOS 5D Mark III": ("Auto Lighting Optimizer (Standard)", False),
        "Canon EOS RP": ("Auto Lighting Optimizer (Standard)", False),
        "ILCE-6400": ("Dynamic Range Optimizer (Auto)", False),
        "SLT-A55V": ("Dynamic Range Optimizer (Auto)", False),
    }


def test_a_model_that_ships_is_one_camera_s():
    """Makers wrote one name for many models into the files of the first digital cameras."""
    assert not {"CYBERSHOT", "FDMAVICA"} & {one.model.upper() for one in shipped_cameras()}
    by_charts = [one.model for one in shipped_cameras() if one.method == "chart"]
    assert len(set(by_charts)) == len(by_charts)


def test_they_are_what_the_stacks_gave(development_data):
    with np.load(development_data / "crf" / "modern_stacks.npz") as stored:
        models = [str(name).removesuffix(" (exposure stacks)") for name in stored["names"]]
        truth = dict(zip(models, stored["inverse"], strict=True))
    solved = [one for one in shipped_cameras() if one.method == "bracket"]
    assert {one.model for one in solved} == set(models)
    for one in solved:
        at = np.interp(np.linspace(0, 1, 1024), one.curve.encoded, one.curve.linear[1])
        # Between 128 codes a curve is straight; the steepest leaves its measurement by 0.006.
        assert np.abs(at - truth[one.model][1]).max() < 0.0065


def test_they_are_what_the_charts_gave(chart_curves):
    with np.load(chart_curves) as stored:
        named = [model for _, model in stored["exif"].tolist()]
        curves = dict(zip(named, stored["inverse"], strict=True))
    for one in shipped_cameras():
        if one.method == "chart":
            at = np.interp(np.linspace(0, 1, 256), one.curve.encoded, one.curve.linear[1])
            # But for the last step to white, which ships half as fine.
            assert np.abs(at - curves[one.model])[:250].max() < 0.003


def test_a_camera_is_found_by_make_and_model():
    found = matching(shipped_cameras(), "Canon Inc.", "canon eos 5d")
    assert [one.model for one in found] == ["Canon EOS 5D"]
    assert matching(shipped_cameras(), "Nikon", "Canon EOS 5D") == ()


@pytest.mark.parametrize(
    ("make", "model", "also"),
    [
        ("Canon", "PowerShot S40", "Canon PowerShot S40"),
        ("NIKON CORPORATION", "NIKON D90", "D90"),
        ("OLYMPUS IMAGING CORP.", "E-M10", "olympus e-m10"),
        ("", "D90", "D90"),
    ],
)
def test_a_model_is_the_same_with_its_makers_name_and_without(make, model, also):
    assert names_of(make, model) == names_of(make, also)
    assert names_of(make, model) != names_of(make, f"{model}x")


def test_a_maker_has_one_spelling():
    makers = one_spelling(
        ["NIKON CORPORATION", "Nikon", "NIKON", "samsung", "Samsung", "NVIDIA", ""]
    )
    assert makers == {"nikon": "Nikon", "samsung": "Samsung", "nvidia": "NVIDIA", "": ""}


@pytest.mark.parametrize(
    ("maker", "model", "name"),
    [
        ("Nikon", "E995", "Nikon E995"),
        ("Nikon", "NIKON D90", "Nikon D90"),
        ("Canon", "Canon EOS 5D", "Canon EOS 5D"),
        ("PENTAX Corporation", "PENTAX *ist DL", "PENTAX Corporation *ist DL"),
        ("Canon", "Canon", "Canon Canon"),
        ("Nikon", "NIKONOS", "Nikon NIKONOS"),
        ("NIKON CORPORATION", "NIKON D90", "NIKON CORPORATION D90"),
        ("", "D90", "D90"),
    ],
)
def test_a_camera_has_its_makers_name_once(maker, model, name):
    assert camera_name(maker, model) == name


def test_measurements_of_one_model_are_listed_together_by_one_name(capfd, registry):
    lines = CommandLine(capfd)("cameras", "list", "e995").out.splitlines()
    assert [line.split()[:2] for line in lines] == [["Nikon", "E995"]] * 2
    assert "exposure stacks" in lines[0]
    assert "photos of a chart" in lines[1]
    every = CommandLine(capfd)("cameras", "list").out.splitlines()
    places = [at for at, line in enumerate(every) if line.startswith("Nikon E995 ")]
    assert len(every) == len(shipped_cameras())
    assert places[1] == places[0] + 1


@pytest.mark.parametrize("name", ["NIKON CORPORATION", "Nikon D3100"])
def test_a_camera_is_found_by_its_files_spelling_and_by_the_lists(capfd, registry, name):
    (line,) = CommandLine(capfd)("cameras", "list", name).out.splitlines()
    assert line.startswith("Nikon D3100 ")


def test_a_measurement_is_added_listed_exported_and_merged(capfd, tmp_path, registry, monkeypatch):
    run = CommandLine(capfd)
    assert run("cameras", "add", record(tmp_path)).code == 0
    ended = run("cameras", "list", "acme")
    assert ended.out.startswith("Acme")
    assert "yours" in ended.out
    (one,) = read_registry(registry)
    assert np.abs(one.curve.linear - gamma_curve(2.2).linear).max() < 1e-4
    assert one.spread_stops == pytest.approx(0.029, abs=0.001)
    assert run("cameras", "export", tmp_path / "mine.json").code == 0
    monkeypatch.setenv("FACECRF_CAMERAS", str(tmp_path / "theirs.json"))
    for _ in range(2):
        assert "json: 1 camera\n" in run("cameras", "merge", tmp_path / "mine.json").out


def known(linear):
    return KnownCamera("Acme", "One", "", "chart", "C", 0.08, "by hand", linear)


def test_a_curve_that_all_channels_share_is_stored_once(tmp_path):
    row = tuple(np.linspace(0.0, 1.0, 5).tolist())
    other = tuple(np.square(row).tolist())
    for linear, stored in (((row,) * 3, 1), ((row, row, other), 3)):
        write_registry(tmp_path / "a.json", [known(linear)], overwrite=True)
        (entry,) = json.loads((tmp_path / "a.json").read_text())["cameras"]
        assert len(entry["linear"]) == stored
        assert read_registry(tmp_path / "a.json") == (known(linear),)


def test_a_registry_with_three_like_rows_is_read(tmp_path):
    """As earlier copies wrote them."""
    linear = ((0.0, 0.25, 1.0),) * 3
    stored = {"format": FORMAT, "cameras": [asdict(known(linear))]}
    (tmp_path / "a.json").write_text(json.dumps(stored))
    assert read_registry(tmp_path / "a.json") == (known(linear),)


def test_an_estimate_is_no_measurement(capfd, tmp_path, registry):
    ended = CommandLine(capfd)("cameras", "add", record(tmp_path, "joint"))
    assert ended.code == 3
    assert "and no measurement" in ended.err
    assert not registry.exists()


def test_what_is_no_registry_is_told(capfd, tmp_path, registry):
    (tmp_path / "other.json").write_text(json.dumps({"format": "x"}))
    ended = CommandLine(capfd)("cameras", "merge", tmp_path / "other.json")
    assert ended.code == 3
    assert "is no registry of cameras" in ended.err
    assert CommandLine(capfd)("cameras", "list", "nothing such").code == 4
