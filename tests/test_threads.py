"""As many processes as this one may use cores, and OpenCV's threads as they were."""

from __future__ import annotations

import os

import click
import cv2
import pytest

from facecrf_ocio.cli.facecrf import main
from facecrf_ocio.files.threads import one_opencv_thread, usable_cores


def test_cores_are_those_that_this_process_may_use(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 3, 5}, raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 64)
    assert usable_cores() == 3


@pytest.mark.parametrize("command", ["batch", "report"])
def test_the_commands_take_one_process_or_thread_for_each(command):
    (jobs,) = [option for option in main.commands[command].params if option.name == "jobs"]
    assert jobs.default is None
    assert "one per core" in click.Context(main.commands[command]).get_help()


def test_opencv_has_its_threads_again_afterward():
    former = cv2.getNumThreads()
    try:
        cv2.setNumThreads(3)
        with one_opencv_thread():
            assert cv2.getNumThreads() == 1
        assert cv2.getNumThreads() == 3
    finally:
        cv2.setNumThreads(former)
