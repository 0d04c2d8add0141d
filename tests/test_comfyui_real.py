"""The workflow in a real ComfyUI, over its HTTP interface.

`FACECRF_COMFYUI` names ComfyUI's folder, `FACECRF_COMFYUI_PYTHON` its Python if that is another;
facecrf_ocio must be importable there. Nothing is written into that folder.
"""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from archive_photos import linear_face, write_picture
from command_line import CommandLine

from facecrf_ocio.synthetic import gamma_curve

COMFYUI = os.environ.get("FACECRF_COMFYUI", "")
PYTHON = os.environ.get("FACECRF_COMFYUI_PYTHON", sys.executable)
NODES = Path(__file__).parents[1] / "nodes" / "comfyui"
_STARTS_S, _RUNS_S = 300.0, 300.0  # on a busy machine; a quiet one takes a tenth

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not COMFYUI, reason="FACECRF_COMFYUI names no folder of ComfyUI"),
]


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    """A folder of ComfyUI's own kind, with the nodes and two photos in it."""
    folder = tmp_path_factory.mktemp("comfyui")
    for name in ("input", "output", "models", "custom_nodes"):
        (folder / name).mkdir()
    shutil.copytree(NODES, folder / "custom_nodes" / "facecrf")
    write_picture(folder / "input" / "photo.png", linear_face(3), gamma_curve(2.2))
    ramp = np.tile(np.linspace(0, 1, 64, dtype=np.float32)[None, :, None], (48, 1, 3))
    write_picture(folder / "input" / "ramp.png", ramp, gamma_curve(2.2))
    return folder


@pytest.fixture(scope="module")
def server(base):
    """The address of a ComfyUI that runs there."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [PYTHON, "main.py", "--cpu", "--port", str(port), "--base-directory", str(base)]
    with (base / "log.txt").open("wb") as log:
        running = subprocess.Popen(command, cwd=COMFYUI, stdout=log, stderr=subprocess.STDOUT)
        address = f"http://127.0.0.1:{port}"
        try:
            until = time.monotonic() + _STARTS_S
            while True:
                try:
                    asked(address, "/system_stats")
                    break
                except OSError:
                    assert running.poll() is None, (base / "log.txt").read_text()
                    assert time.monotonic() < until, (base / "log.txt").read_text()
                    time.sleep(1.0)
            yield address
        finally:
            running.terminate()
            running.wait(30)


def asked(address, path, body=None):
    data = None if body is None else json.dumps(body).encode()
    kind = {"Content-Type": "application/json"}
    request = urllib.request.Request(address + path, data, kind)  # noqa: S310 -- http, our own
    with urllib.request.urlopen(request, timeout=30) as answer:  # noqa: S310
        return json.load(answer)


def run(address, photo):
    """What ComfyUI's history says of the workflow with this photo."""
    workflow = json.loads((NODES / "linearize_photo.json").read_text())
    workflow["1"]["inputs"]["image"] = photo
    number = asked(address, "/prompt", {"prompt": workflow})["prompt_id"]
    until = time.monotonic() + _RUNS_S
    while not (told := asked(address, f"/history/{number}")):
        assert time.monotonic() < until
        time.sleep(0.5)
    return told[number]


def pixels(path):
    return np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT))[..., :3]


def test_its_nodes_are_offered(server):
    offered = asked(server, "/object_info/FaceCRFLinearizePhoto")["FaceCRFLinearizePhoto"]
    assert offered["display_name"] == "Linearize Photo"
    assert offered["category"] == "image/color"


def test_the_workflow_writes_what_linearize_writes(server, base, capfd):
    told = run(server, "photo.png")
    assert told["status"]["status_str"] == "success"
    ended = CommandLine(capfd)(
        "linearize", base / "input" / "photo.png", "-o", base / "expected.exr", "--half"
    )
    assert ended.code == 0, ended.err
    made, expected = pixels(base / "output" / "linear.0001.exr"), pixels(base / "expected.exr")
    assert np.abs(made - expected).max() < 1e-3
    assert told["outputs"]["5"]["images"]  # and the preview of the way back


def test_a_photo_without_a_face_is_told_on_the_node(server):
    told = run(server, "ramp.png")
    assert told["status"]["status_str"] == "error"
    (said,) = [what for kind, what in told["status"]["messages"] if kind == "execution_error"]
    assert said["node_type"] == "FaceCRFLinearizePhoto"
    assert "face" in said["exception_message"]
