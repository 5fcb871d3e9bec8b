"""Signals are put off where they may not come between, and never lost."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import simmpp
from simmpp.common.compiled import cfunc, njit
from simmpp.common.interrupts import Interrupt, Uninterrupted, last_word
from simmpp.sweeps.journal import Outcome
from simmpp.sweeps.sweep import Watcher


@pytest.fixture(autouse=True)
def as_python_begins() -> Iterator[None]:
    """Whatever began the tests: in the background of a shell Ctrl-C is ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def interrupt() -> None:
    os.kill(os.getpid(), signal.SIGINT)


def test_what_came_meanwhile_is_raised_afterwards() -> None:
    steps = []
    with pytest.raises(KeyboardInterrupt), Uninterrupted():
        interrupt()
        with Uninterrupted():
            interrupt()
            steps.append("inner")
        steps.append("outer")
    assert steps == ["inner", "outer"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    with pytest.raises(KeyboardInterrupt):
        interrupt()


def test_other_errors_are_not_lost() -> None:
    with pytest.raises(KeyboardInterrupt) as caught, Uninterrupted():
        interrupt()
        raise ZeroDivisionError
    assert isinstance(caught.value.__context__, ZeroDivisionError)
    with pytest.raises(ZeroDivisionError), Uninterrupted():
        raise ZeroDivisionError


@pytest.mark.parametrize("handler", [signal.SIG_IGN, lambda *_: None])
def test_who_wants_no_exception_gets_none(handler: signal.Handlers) -> None:
    signal.signal(signal.SIGINT, handler)
    with Uninterrupted():
        interrupt()
    assert signal.getsignal(signal.SIGINT) is handler


def test_other_threads_are_left_alone() -> None:
    problems = []

    def work() -> None:
        try:
            with Uninterrupted():
                pass
        except BaseException as problem:
            problems.append(problem)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert problems == []


def test_words_and_codes() -> None:
    assert last_word(KeyboardInterrupt()) == ("interrupted", 130)
    assert last_word(Interrupt(signal.SIGTERM)) == ("terminated", 143)


@pytest.mark.parametrize("after_s", [0.001, 0.03, 0.2])
def test_no_interrupt_is_lost_in_a_compiler(after_s: float) -> None:
    """numba calls Python back from LLVM, which drops what is raised there."""

    def summed(n: int) -> float:
        total = 0.0
        for i in range(n):
            total += i % 7
        return total

    compiled = njit(summed)
    with pytest.raises(KeyboardInterrupt):
        interrupted_in(after_s)
        compiled(8)
        cfunc("float64(int64)", "summed")(summed)
        wait()
    assert compiled(8) == 21


def interrupted_in(after_s: float) -> None:
    signal.signal(signal.SIGALRM, lambda *_: interrupt())
    signal.setitimer(signal.ITIMER_REAL, after_s)


def wait() -> None:
    """For an interrupt, and not for ever if it is lost."""
    time.sleep(60)


def test_python_callers_get_their_keyboard_interrupt() -> None:
    scene, picture = simmpp.load_scene("tetra:3"), simmpp.Picture(resolution=64)
    with pytest.raises(KeyboardInterrupt):
        simmpp.trace(scene, picture, lambda done, total: interrupt())
    workload = simmpp.trace(scene, picture)
    machine = simmpp.make_machine("t3e", processors=4)
    placement = simmpp.place(workload, 4, simmpp.Memory(), simmpp.PlacementRules(), seed=0)
    call = (workload, machine, placement, simmpp.PolicyParameters("concurrent"))
    with pytest.raises(KeyboardInterrupt):
        simmpp.simulate(*call, progress=lambda rays_left: interrupt())
    assert simmpp.simulate(*call).rays == workload.n_rays


@pytest.mark.parametrize("workers", [1, 2])
def test_an_interrupted_sweep_leaves_no_process_and_goes_on(tmp_path: Path, workers: int) -> None:
    class Interrupting(Watcher):
        def simulated(self, outcome: Outcome) -> None:
            interrupt()

    config = {
        "scene": "tetra:2",
        "picture": {"resolution": 8},
        "sweep": {"processors": [2, 4, 8]},
        "policy": "ray",
    }
    with pytest.raises(KeyboardInterrupt):
        simmpp.sweep(config, out=tmp_path, workers=workers, watcher=Interrupting())
    assert multiprocessing.active_children() == []
    assert len((tmp_path / "points.jsonl").read_text().splitlines()) >= 2
    rows, _ = simmpp.sweep(config, out=tmp_path)
    assert not rows["error"].notna().any()


def test_an_interrupt_while_workers_begin_is_heard_at_once() -> None:
    config = {"scene": "tetra:2", "picture": {"resolution": 8}, "processors": 2}
    with pytest.raises(KeyboardInterrupt):
        interrupted_in(0.05)
        simmpp.sweep(config, workers=2)
        wait()
