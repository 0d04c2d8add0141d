"""A registry of cameras that changed between two runs over an archive."""

from __future__ import annotations

import json

import numpy as np
import pytest
from archive_photos import ONE, table, write_face
from command_line import CommandLine
from dask_cluster import DaskCluster

from facecrf_ocio.archive.cameras.registry import reopen_measured
from facecrf_ocio.archive.manifest.database import Manifest, Stamp
from facecrf_ocio.archive.task import Result
from facecrf_ocio.cameras.known_cameras import (
    POINTS,
    KnownCamera,
    own_cameras,
    own_cameras_are,
    write_registry,
)
from facecrf_ocio.errors import OutputError
from facecrf_ocio.record.calibration_record import read_record

_RECIPE = "the recipe"


def measured(model: str, exponent: float = 2.2) -> KnownCamera:
    row = tuple((np.linspace(0.0, 1.0, POINTS) ** exponent).tolist())
    return KnownCamera("Acme", model, "", "pair", "A", 0.06, "by hand", (row, row, row))


@pytest.fixture
def registry(monkeypatch, tmp_path):
    path = tmp_path / "cameras.json"
    monkeypatch.setenv("FACECRF_CAMERAS", str(path))

    def write(*cameras):
        write_registry(path, cameras, overwrite=True)

    return write


@pytest.fixture
def manifest(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    found = Manifest(folder)
    for name, model in (("a.jpg", "One"), ("b.jpg", " ONE"), ("c.jpg", "Two"), ("d.jpg", "")):
        with found.transaction():
            result = Result("calibrated", "weak", camera=("Acme", model, "", ""))
            found.finish(name, Stamp(1, 1, _RECIPE), result)
    yield found
    found.close()


def done(manifest):
    return {name for name, recipe in manifest.rows("SELECT name, recipe FROM photos") if recipe}


def test_photos_of_a_model_that_was_measured_since_are_taken_back(manifest, registry):
    assert reopen_measured(manifest) == 0
    registry(measured("One"))
    assert reopen_measured(manifest) == 2
    assert done(manifest) == {"c.jpg", "d.jpg"}
    assert reopen_measured(manifest) == 0


def test_only_what_changed_is(manifest, registry):
    registry(measured("One"), measured("Two"))
    reopen_measured(manifest)
    with manifest.transaction():
        manifest.change("UPDATE photos SET recipe = ?", _RECIPE)
    registry(measured("Two"), measured("One"), measured("Three"))
    assert reopen_measured(manifest) == 0
    registry(measured("One"), measured("Two", 2.4), measured("Three"))
    assert reopen_measured(manifest) == 1
    registry(measured("Two", 2.4))
    assert reopen_measured(manifest) == 2


def test_a_damaged_note_of_it_is_told(manifest, registry):
    registry(measured("One"))
    with manifest.transaction():
        manifest.note("cameras", "[")
    with pytest.raises(OutputError, match="holds what no facecrf wrote"):
        reopen_measured(manifest)


@pytest.mark.slow
@pytest.mark.parametrize("pool", ["none", "camera"])
def test_a_batch_does_them_again_and_no_others(capfd, tmp_path, registry, pool):
    facecrf, source, output = CommandLine(capfd), tmp_path / "photos", tmp_path / "luts"
    for seed, said in enumerate((ONE, ONE, {"Make": "Acme", "Model": "Two"})):
        write_face(source / f"{seed}.jpg", seed, **said)
    how = ("batch", source, "-o", output, "--pool", pool, "--formats", "spi1d", "--jobs", "1")
    assert facecrf(*how).code == 0
    registry(measured("One"))
    ended = facecrf(*how)
    assert ended.code == 0
    assert "1 done before" in ended.err
    for name, counts in (("0.jpg", True), ("1.jpg", True), ("2.jpg", False)):
        told = read_record(output / f"{name}.crf.json").estimate.confidence
        said = [*told.reasons, *told.doubts]
        assert any("the measured response of Acme One" in one for one in said) == counts
    assert "3 done before" in facecrf(*how).err
    (noted,) = table(output, "SELECT value FROM about WHERE key = 'cameras'")
    # With its maker's name and without, as files write it.
    assert set(json.loads(noted[0])) == {"one", "acme one"}


@pytest.mark.slow
def test_a_cluster_goes_by_the_registry_of_who_asks(capfd, tmp_path, monkeypatch):
    pytest.importorskip("distributed", reason="the extra cluster is not installed")
    facecrf, source = CommandLine(capfd), tmp_path / "photos"
    write_face(source / "0.jpg", 0, **ONE)
    write_face(source / "1.jpg", 1, Make="Acme", Model="Two")
    theirs, ours, folder = tmp_path / "theirs.json", tmp_path / "ours.json", tmp_path / "cluster"
    write_registry(theirs, [measured("Two")], overwrite=True)
    folder.mkdir()
    with DaskCluster(folder) as cluster:
        cluster.add_worker(FACECRF_CAMERAS=str(theirs))
        cluster.wait_for_workers(1)
        monkeypatch.setenv("FACECRF_CAMERAS", str(ours))
        for known in ([], [measured("One")]):
            write_registry(ours, known, overwrite=True)
            output = tmp_path / f"{len(known)} known"
            how = ("batch", source, "-o", output, "--formats", "spi1d", "--ship")
            assert facecrf(*how, "--scheduler", cluster.address).code == 0
            assert counted_as_known(output / "0.jpg.crf.json") == bool(known)
            assert not counted_as_known(output / "1.jpg.crf.json")


def counted_as_known(record):
    told = read_record(record).estimate.confidence
    return any("the measured response of Acme" in one for one in (*told.reasons, *told.doubts))


def test_cameras_that_came_with_the_work_count_in_its_block_alone(registry):
    registry(measured("One"))
    with own_cameras_are((measured("Two"),)):
        assert [one.model for one in own_cameras()] == ["Two"]
        with own_cameras_are(None):
            assert [one.model for one in own_cameras()] == ["One"]
    assert [one.model for one in own_cameras()] == ["One"]
