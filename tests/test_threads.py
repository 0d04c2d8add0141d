"""As many processes as this one may use cores, and OpenCV's threads as they were."""

from __future__ import annotations

import os
import threading
from functools import partial

import click
import cv2
import pytest

from facecrf_ocio.cli.facecrf import main
from facecrf_ocio.files.threads import (
    OtherThread,
    WhileAny,
    beside,
    one_opencv_thread,
    usable_cores,
)


def test_cores_are_those_that_this_process_may_use(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 3, 5}, raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 64)
    assert usable_cores() == 3


@pytest.mark.parametrize("command", ["batch", "report"])
def test_the_commands_take_one_process_or_thread_for_each(command):
    (jobs,) = [option for option in main.commands[command].params if option.name == "jobs"]
    context = click.Context(main.commands[command])
    assert not isinstance(jobs.get_default(context), int)  # None, or the mark for nothing
    assert "one per core" in context.get_help()


def test_opencv_has_its_threads_again_afterward():
    former = cv2.getNumThreads()
    try:
        cv2.setNumThreads(3)
        with one_opencv_thread():
            assert cv2.getNumThreads() == 1
        assert cv2.getNumThreads() == 3
    finally:
        cv2.setNumThreads(former)


@pytest.fixture
def several_threads():
    former = cv2.getNumThreads()
    cv2.setNumThreads(2)
    yield
    cv2.setNumThreads(former)


def test_work_begins_before_its_result_is_asked_for(several_threads):
    begun = threading.Event()
    with OtherThread() as other:
        ask = other.begin(lambda: begun.set() or threading.get_ident())
        assert begun.wait(timeout=60)
        assert ask() == other.begin(threading.get_ident)() != threading.get_ident()


def test_work_is_done_in_this_thread_where_there_is_but_one(several_threads):
    with one_opencv_thread(), OtherThread() as other:
        assert other.begin(threading.get_ident)() == threading.get_ident()


def test_what_fails_in_a_thread_fails_where_it_is_asked_for(several_threads):
    with pytest.raises(ZeroDivisionError), OtherThread() as other:
        other.begin(lambda: 1 // 0)()


def test_what_is_not_asked_for_is_dropped(several_threads):
    done, go = [], threading.Event()
    with OtherThread() as other:
        first = other.begin(lambda: go.wait(timeout=60))
        other.begin(lambda: done.append(1))
    go.set()
    assert first()
    assert not done


def test_work_beside_other_work_is_done_when_that_is():
    done = []
    with beside(lambda: done.append(threading.get_ident())):
        pass
    assert done
    assert done != [threading.get_ident()]


def test_what_fails_beside_other_work_is_no_fault_of_that():
    with beside(lambda: 1 // 0):
        pass
    with pytest.raises(KeyError), beside(lambda: 1 // 0):
        raise KeyError


@pytest.mark.parametrize("first_out", [0, 1])
def test_what_threads_share_is_ended_by_the_last_of_them(first_out):
    state = ["loud"]

    def begin():
        former, state[0] = state[0], "quiet"
        return lambda: state.__setitem__(0, former)

    shared = WhileAny(begin)
    for _ in range(2):
        inside = [shared(), shared()]
        for one in inside:
            one.__enter__()
        inside[first_out].__exit__(None, None, None)
        assert state == ["quiet"]
        inside[1 - first_out].__exit__(None, None, None)
        assert state == ["loud"]


def test_it_ends_where_the_block_fails():
    opened = []
    shared = WhileAny(lambda: opened.append("begun") or partial(opened.append, "ended"))
    with pytest.raises(OSError, match="lost"), shared():
        raise OSError("lost")
    assert opened == ["begun", "ended"]
