"""Ctrl-C at random moments of every command: one line, exit code 130, and no process is left.

``SIMMPP_INTERRUPTS=10 pytest -s tests/stress/test_interrupts.py`` interrupts each command so often,
and prints how long each took to end; ``SIMMPP_INTERRUPTS_SEED`` chooses other moments.
"""

import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from simmpp.common.cache import cache_folder

INTERRUPTS = int(os.environ.get("SIMMPP_INTERRUPTS", "1"))
SEED = int(os.environ.get("SIMMPP_INTERRUPTS_SEED", "0"))
FIRST_S, LAST_S = 0.3, 6.0
"""Of a process: Python has begun; all commands still trace, simulate or draw."""
PROGRAM = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # what runs in the background ignores it
from simmpp.__main__ import main
if __name__ == "__main__":
    main()
"""
CONFIG = """
scene: mountain:6
picture: {resolution: 1500}
processors: 8
"""
COMMANDS = {
    "run": "run c.yaml --out o",
    "workload": "workload c.yaml",
    "scene": "scene rings:14 --preview p.png",
    "sweep of 1": "sweep c.yaml --workers 1 --out o",
    "sweep of 2": "sweep c.yaml --workers 2 --out o",
    "model": "model c.yaml --out o",
    "bench": "bench c.yaml --workers 2 --out o",
    "check": "check c.yaml --workers 1 --baseline profits.csv --update",
    "reproduce": "reproduce --workers 2 --out o",
}


HOW_FAR = re.compile(r"simmpp: \d+ of \d+ simulations? done(; to go on: simmpp .*)?")
"""What sweeps say before."""


@pytest.mark.parametrize("number", range(INTERRUPTS))
@pytest.mark.parametrize("name", COMMANDS)
def test_interrupted_at_any_moment(tmp_path: Path, name: str, number: int) -> None:
    after_s = random.Random(f"{SEED} {name} {number}").uniform(FIRST_S, LAST_S)
    code, lines = ended_by(signal.SIGINT, name, after_s, tmp_path)
    assert (code, lines[-1]) == (130, "simmpp: interrupted")
    assert all(HOW_FAR.fullmatch(line) for line in lines[:-1]) and len(lines) <= 2, lines


@pytest.mark.parametrize("name", ["run", "sweep of 2"])
def test_terminated_is_likewise(tmp_path: Path, name: str) -> None:
    code, lines = ended_by(signal.SIGTERM, name, 3.0, tmp_path)
    assert (code, lines[-1]) == (143, "simmpp: terminated")
    assert all(HOW_FAR.fullmatch(line) for line in lines[:-1]) and len(lines) <= 2, lines


def test_what_fails_because_of_a_signal_is_not_told(tmp_path: Path) -> None:
    """As a pipe to a worker that the same signal has ended."""
    broken = PROGRAM.replace(
        "    main()", "    from simmpp.common.interrupts import ending_on_signals"
    )
    broken += """
    import os
    with ending_on_signals():
        try:
            os.kill(os.getpid(), signal.SIGINT)
        except KeyboardInterrupt:
            raise BrokenPipeError("the worker is gone") from None
"""
    ended = begun(tmp_path, broken, [])
    assert (ended.communicate()[1], ended.returncode) == ("simmpp: interrupted\n", 130)


def test_code_that_hears_nothing_does_not_hold_the_process(tmp_path: Path) -> None:
    """As LLVM, or any other library: here a thousand seconds in one call, in foreign hands."""
    deaf = PROGRAM.replace(
        "    main()", "    from simmpp.common.interrupts import ending_on_signals"
    )
    deaf += """
    import ctypes, time
    with ending_on_signals():
        began = time.monotonic()
        slept = ctypes.CDLL(None).sleep
        print("asleep", flush=True)
        while time.monotonic() < began + 1000:
            slept(1000)
"""
    process = begun(tmp_path, deaf, [])
    assert process.stdout is not None and process.stdout.readline() == "asleep\n"
    os.killpg(process.pid, signal.SIGINT)
    os.killpg(process.pid, signal.SIGINT)  # in its pipe already when the first one is answered
    assert process.communicate()[1] == "simmpp: interrupted\n"
    assert process.returncode == 130


def ended_by(
    number: signal.Signals, name: str, after_s: float, folder: Path
) -> tuple[int, list[str]]:
    """The exit code and the last lines of a command that gets a signal, as do its children."""
    (folder / "c.yaml").write_text(CONFIG)
    process = begun(folder, PROGRAM, COMMANDS[name].split())
    time.sleep(after_s)
    assert process.poll() is None, process.communicate()
    os.killpg(process.pid, number)
    sent_s = time.monotonic()
    process.wait()
    ended_s = time.monotonic() - sent_s
    errors = process.communicate()[1]  # when all that write there have ended
    gone_s = time.monotonic() - sent_s
    print(f"{name}: after {after_s:.2f} s; ended in {ended_s:.2f} s, its children {gone_s:.2f} s")
    progress = re.compile(r"simmpp: \d+ of \d+, .*|simmpp: compiling for this machine, .*")
    lines = [line for line in errors.splitlines() if not progress.fullmatch(line)]
    return process.returncode, lines


def begun(folder: Path, program: str, arguments: list[str]) -> subprocess.Popen[str]:
    """A command in a session of its own, with compiled code from before and no workload."""
    compiled = os.environ.get("NUMBA_CACHE_DIR") or str(cache_folder() / "compiled")
    caches = {"SIMMPP_CACHE": str(folder / "cache"), "NUMBA_CACHE_DIR": compiled}
    script = folder / "script.py"
    script.write_text(program)
    return subprocess.Popen(
        [sys.executable, str(script), *arguments],
        cwd=folder,
        env=os.environ | caches,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
