"""A Dask cluster does what this machine does, byte for byte, whatever happens to its workers."""

from __future__ import annotations

import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from command_line import CODE, write_noise
from dask_cluster import Certificates, DaskCluster
from test_archive_batch import archive, files, rows  # noqa: F401 - a fixture

import facecrf_ocio
from facecrf_ocio import __version__
from facecrf_ocio.archive.manifest.connection import FILE
from facecrf_ocio.archive.place import Place
from facecrf_ocio.archive.task import Recipe, Task
from facecrf_ocio.archive.work.parcel import Parcel, unpack
from facecrf_ocio.archive.work.processes import Limits
from facecrf_ocio.files.versions import difference, versions

OPTIONS = ("--estimator", "mean", "--formats", "spi1d")
NOWHERE = "tcp://127.0.0.1:1"  # tcpmux, which nobody runs


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """One scheduler with one worker, behind a nanny as `dask worker` starts it."""
    pytest.importorskip("distributed", reason="the extra cluster is not installed")
    with DaskCluster(tmp_path_factory.mktemp("cluster")) as running:
        running.add_worker()
        running.wait_for_workers(1)
        yield running


@pytest.fixture
def own_cluster(tmp_path):
    """A scheduler without workers, for a test that breaks things."""
    pytest.importorskip("distributed", reason="the extra cluster is not installed")
    folder = tmp_path / "own cluster"
    folder.mkdir()
    with DaskCluster(folder) as running:
        yield running


def batch(facecrf, source, output, *more):
    return facecrf("batch", source, "-o", output, *OPTIONS, *more)


def command(source, output, *more):
    arguments = ["batch", source, "-o", output, *OPTIONS, *more]
    return [sys.executable, "-c", CODE, *map(str, arguments)]


def done(output: Path) -> int:
    if not (output / FILE).exists():
        return 0
    try:
        return sum(state == "done" for (state,) in rows(output, "state"))
    except sqlite3.OperationalError:  # its tables are not there yet
        return 0


def many(folder: Path, count: int) -> Path:
    folder.mkdir()
    for number in range(count):
        write_noise(folder / f"{number:03}.png", seed=number)
    (folder / "cut.png").write_bytes((folder / "000.png").read_bytes()[:300])
    return folder


@pytest.fixture
def parcel(archive, tmp_path):  # noqa: F811
    """A photo as a worker that sees everything gets it."""
    mark = tmp_path / "o" / "mark"
    mark.parent.mkdir()
    mark.touch()
    place = Place.of(mark.parent)
    task = Task(archive / "a.jpg", "a.jpg", place, Recipe("mean", formats=("spi1d",)))
    status = task.source.stat()
    return Parcel(
        task,
        Limits(),
        source=task.source,
        folder=task.place.folder,
        versions=versions(),
        digest=task.recipe.sha256(__version__),
        mark=mark,
        size=status.st_size,
        mtime_ns=status.st_mtime_ns,
    )


def test_a_worker_that_sees_the_paths_writes_there_and_one_that_does_not_sends_bytes(parcel):
    written = unpack(parcel)
    assert written.contents == ()
    here = [(parcel.folder / output.name).read_bytes() for output in written.result.outputs]
    sent = unpack(replace(parcel, photo=parcel.source.read_bytes(), folder=Path("/not/here")))
    assert list(sent.contents) == here
    assert sent.result.outputs == written.result.outputs
    assert len(here) == 2


def test_what_a_worker_says_names_the_paths_of_the_client(parcel):
    task = replace(parcel.task, source=Path("photos/cut.png"))
    result = unpack(replace(parcel, task=task, photo=b"no photo")).result
    assert result.outcome == "failed"
    assert "/" not in result.reason
    assert "/tmp" not in result.reason  # noqa: S108


@pytest.mark.parametrize(
    "change", [{"size": 1}, {"mtime_ns": 1}, {"source": Path("/no/photo")}, {"mark": Path("/no/m")}]
)
def test_a_worker_that_sees_other_files_does_not_touch_them(parcel, change):
    delivery = unpack(replace(parcel, **change))
    assert delivery.result is None
    assert delivery.unseen
    assert [path.name for path in parcel.folder.iterdir()] == ["mark"]


@pytest.mark.parametrize("change", [{"versions": {"numpy": "0.1"}}, {"digest": "another"}])
def test_a_worker_of_other_versions_or_settings_does_nothing(parcel, change):
    delivery = unpack(replace(parcel, **change))
    assert delivery.result is None
    assert delivery.unlike


def test_a_difference_of_versions_names_the_library():
    assert difference({"a": "1", "b": "2"}, {"a": "1", "b": "3"}) == "b is 3 there and 2 here"
    assert difference({"a": "1"}, {}) == "a is missing there and 1 here"
    assert difference({"a": "1"}, {"a": "1", "b": "3"}) == ""


def test_nobody_at_the_address_is_told_in_one_line(facecrf, archive, tmp_path):  # noqa: F811
    pytest.importorskip("distributed", reason="the extra cluster is not installed")
    ended = batch(facecrf, archive, tmp_path / "o", "--scheduler", NOWHERE)
    assert ended.code == 1
    (line,) = ended.err.splitlines()  # no count of photos where none was looked at
    assert line.startswith("facecrf:")
    assert f"{NOWHERE}: no Dask scheduler answers there" in line


def test_without_the_extra_it_is_named(archive, tmp_path):  # noqa: F811
    code = f"import sys; sys.modules['distributed'] = None; {CODE}"
    arguments = ["batch", str(archive), "-o", str(tmp_path / "o"), "--scheduler", NOWHERE]
    ended = subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False
    )
    assert ended.returncode == 2
    assert "pip install 'facecrf-ocio[cluster]'" in ended.stderr
    assert "Traceback" not in ended.stderr


def test_shipping_is_for_schedulers(facecrf, archive, tmp_path):  # noqa: F811
    ended = batch(facecrf, archive, tmp_path / "o", "--ship")
    assert ended.code == 2


@pytest.mark.slow
@pytest.mark.parametrize("how", [(), ("--ship",), ("--no-ship",), ("--exr",), ("--exr", "--ship")])
def test_outputs_and_manifest_are_those_of_a_local_run(
    facecrf,
    archive,  # noqa: F811
    cluster,
    tmp_path,
    how,
):
    local, remote = tmp_path / "local", tmp_path / "remote"
    exr = tuple(option for option in how if option == "--exr")
    assert batch(facecrf, archive, local, "--jobs", "1", *exr).code == 3
    assert batch(facecrf, archive, remote, "--scheduler", cluster.address, *how).code == 3
    assert rows(remote) == rows(local)
    assert files(remote) == files(local)
    assert facecrf("verify", remote).code == 0


@pytest.mark.slow
def test_photos_are_shipped_when_a_worker_does_not_see_them(
    facecrf,
    archive,  # noqa: F811
    cluster,
    tmp_path,
    monkeypatch,
):
    monkeypatch.chdir(tmp_path)
    source = Path("/proc/self/cwd", archive.name)  # the same path, but of every process another
    if not source.exists():
        pytest.skip("there is no /proc here")
    refused = batch(facecrf, source, tmp_path / "no", "--scheduler", cluster.address, "--no-ship")
    assert refused.code == 1
    assert "does not see it" in refused.err
    assert "--ship" in refused.err
    assert batch(facecrf, source, tmp_path / "local").code == 3
    assert batch(facecrf, source, tmp_path / "remote", "--scheduler", cluster.address).code == 3
    assert rows(tmp_path / "remote") == rows(tmp_path / "local")
    assert files(tmp_path / "remote") == files(tmp_path / "local")


@pytest.mark.slow
@pytest.mark.parametrize("how", [(), ("--ship",)])
def test_a_worker_killed_half_way_changes_nothing(facecrf, own_cluster, tmp_path, how):
    source, remote = many(tmp_path / "photos", 60), tmp_path / "remote"
    killed = own_cluster.add_worker("--no-nanny")
    own_cluster.add_worker("--no-nanny")
    own_cluster.wait_for_workers(2)
    run = subprocess.Popen(
        command(source, remote, "--scheduler", own_cluster.address, *how),
        stderr=subprocess.PIPE,
        text=True,
    )
    while done(remote) < 20 and run.poll() is None:
        time.sleep(0.02)
    assert 20 <= done(remote) < 61
    own_cluster.kill_worker(killed)
    _, told = run.communicate(timeout=300)
    assert run.returncode == 3, told
    lines = [line for line in told.splitlines() if " left, " not in line]  # how far it is
    assert len(lines) == 2, told  # the broken photo, and the counts
    assert batch(facecrf, source, tmp_path / "local").code == 3
    assert rows(remote) == rows(tmp_path / "local")
    assert files(remote) == files(tmp_path / "local")
    assert facecrf("verify", remote).code == 0


@pytest.mark.slow
def test_a_lost_scheduler_ends_the_run_and_a_local_one_goes_on(facecrf, own_cluster, tmp_path):
    source, output = many(tmp_path / "photos", 60), tmp_path / "luts"
    own_cluster.add_worker("--no-nanny")
    own_cluster.wait_for_workers(1)
    run = subprocess.Popen(
        command(source, output, "--scheduler", own_cluster.address),
        stderr=subprocess.PIPE,
        text=True,
    )
    while done(output) < 10 and run.poll() is None:
        time.sleep(0.05)
    assert 10 <= done(output) < 61
    os.killpg(own_cluster.scheduler.pid, signal.SIGKILL)
    _, told = run.communicate(timeout=300)
    assert run.returncode == 1, told
    assert "start again to go on" in told.splitlines()[-1]
    assert "Traceback" not in told
    for worker in own_cluster.workers:  # it may still be at its last photo
        own_cluster.kill_worker(worker.pid)
    assert batch(facecrf, source, output).code == 3
    assert batch(facecrf, source, tmp_path / "whole").code == 3
    assert rows(output) == rows(tmp_path / "whole")
    assert files(output) == files(tmp_path / "whole")


@pytest.mark.slow
def test_a_worker_with_another_version_is_told_by_name(
    facecrf,
    archive,  # noqa: F811
    own_cluster,
    tmp_path,
):
    other = tmp_path / "other"
    package = other / "facecrf_ocio"
    shutil.copytree(Path(facecrf_ocio.__file__).parent, package)
    start = package / "__init__.py"
    text = start.read_text(encoding="utf-8")
    start.write_text(text.replace(f'"{__version__}"', '"0.0.1"'), encoding="utf-8")
    own_cluster.add_worker(PYTHONPATH=str(other))
    own_cluster.wait_for_workers(1)
    ended = batch(facecrf, archive, tmp_path / "o", "--scheduler", own_cluster.address)
    assert ended.code == 1
    assert f"facecrf_ocio is 0.0.1 there and {__version__} here" in ended.err
    assert rows(tmp_path / "o") == []


@pytest.fixture(scope="module")
def certificates(tmp_path_factory):
    if shutil.which("openssl") is None:
        pytest.skip("there is no openssl here to make certificates")
    return Certificates(tmp_path_factory.mktemp("certificates"))


@pytest.fixture(scope="module")
def tls_cluster(certificates, tmp_path_factory):
    """A scheduler and a worker that speak TLS alone."""
    pytest.importorskip("distributed", reason="the extra cluster is not installed")
    with DaskCluster(tmp_path_factory.mktemp("tls"), certificates) as running:
        running.add_worker("--no-nanny")
        yield running


def shown(certificates, who="own"):
    """As `facecrf batch` takes them."""
    return [option.replace("--tls-ca-file", "--tls-ca") for option in certificates.options(who)]


@pytest.mark.slow
def test_a_cluster_that_speaks_tls_alone_does_what_a_local_run_does(
    facecrf,
    archive,  # noqa: F811
    tls_cluster,
    certificates,
    tmp_path,
):
    local, remote = tmp_path / "local", tmp_path / "remote"
    assert tls_cluster.address.startswith("tls://")
    assert batch(facecrf, archive, local, "--jobs", "1").code == 3
    how = ("--scheduler", tls_cluster.address, *shown(certificates))
    ended = batch(facecrf, archive, remote, *how)
    assert ended.code == 3, ended.err + tls_cluster.log()
    assert rows(remote) == rows(local)
    assert files(remote) == files(local)


@pytest.mark.slow
@pytest.mark.parametrize("client", ["plain", "plain to the port", "stranger"])
def test_who_shows_no_certificate_of_the_authority_is_refused(
    facecrf,
    archive,  # noqa: F811
    tls_cluster,
    certificates,
    tmp_path,
    client,
):
    address = tls_cluster.address
    if client == "plain to the port":
        address = address.replace("tls://", "tcp://")
    how = shown(certificates, "stranger") if client == "stranger" else ()
    ended = batch(facecrf, archive, tmp_path / "o", "--scheduler", address, *how)
    assert ended.code == 1
    (line,) = ended.err.splitlines()
    assert f"{address}: no Dask scheduler answers there" in line
    assert ("--tls-ca" in line) == (client != "stranger")
    assert files(tmp_path / "o") == {}


def test_certificates_that_cannot_be_read_are_told(facecrf, archive, tmp_path):  # noqa: F811
    pytest.importorskip("distributed", reason="the extra cluster is not installed")
    none = [f"--tls-{what}={tmp_path / 'none.pem'}" for what in ("ca", "cert", "key")]
    ended = batch(facecrf, archive, tmp_path / "o", "--scheduler", "tls://127.0.0.1:1", *none)
    assert ended.code == 2
    assert "none.pem: cannot be read; name a file in PEM" in ended.err


def test_certificates_belong_together(facecrf, archive, tmp_path):  # noqa: F811
    one = f"--tls-ca={archive / 'a.jpg'}"
    ended = batch(facecrf, archive, tmp_path / "o", "--scheduler", "tls://127.0.0.1:1", one)
    assert ended.code == 2
    assert "belong together" in ended.err
