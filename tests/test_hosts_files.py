"""Files for hosts that cannot be started here: what can be said of them without the host."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

NODES = Path(__file__).parents[1] / "nodes"
# The knobs in The Foundry's published source of the node, and those that every node has.
OCIO_FILE_TRANSFORM = {"file", "version", "cccid", "invert", "interpolation", "working_space"}
EVERY_NODE = {"name", "inputs", "help", "selected", "addUserKnob", "label"}


def nuke_nodes():
    """(class, {knob: value}) of each node, a line a knob, as Nuke writes scripts."""
    text = (NODES / "nuke" / "linearize_photo.nk").read_text("ascii")
    for kind, body in re.findall(r"^ *(\w+) \{\n(.*?)^ *\}$", text, re.MULTILINE | re.DOTALL):
        lines = (line.strip().partition(" ") for line in body.splitlines())
        yield kind, {knob: value for knob, _, value in lines}


def test_the_nuke_group_is_balanced_and_ends():
    text = (NODES / "nuke" / "linearize_photo.nk").read_text("ascii")
    assert text.count("{") == text.count("}")
    assert text.count('"') % 2 == 0
    assert text.startswith("Group {\n")
    assert text.endswith("}\nend_group\n")


def test_the_nuke_group_has_one_input_one_curve_and_one_output():
    kinds = [kind for kind, _ in nuke_nodes()]
    assert kinds == ["Group", "Input", "OCIOFileTransform", "Output"]


def test_nuke_applies_the_lut_to_raw_values_by_linear_interpolation():
    knobs = dict(nuke_nodes())["OCIOFileTransform"]
    assert knobs["working_space"] == "raw"
    assert knobs["interpolation"] == "linear"
    assert set(knobs) <= OCIO_FILE_TRANSFORM | EVERY_NODE


def test_the_nuke_groups_knob_shows_that_of_the_curve():
    nodes = dict(nuke_nodes())
    linked = re.findall(r"T (\w+)\.file", (NODES / "nuke" / "linearize_photo.nk").read_text())
    assert linked == [nodes["OCIOFileTransform"]["name"]]


@pytest.mark.parametrize("host", ["natron", "gaffer"])
def test_scripts_for_hosts_compile(host):
    script = NODES / host / "linearize_photo.py"
    compile(script.read_text("utf-8"), str(script), "exec")


@pytest.mark.parametrize("host", ["nuke", "natron", "gaffer", "resolve", "icc"])
def test_every_host_says_whether_it_was_run(host):
    text = (NODES / host / "README.md").read_text("utf-8")
    assert ("**Run here**" in text) != ("**Not run here**" in text)
