"""What a hook costs: `python tests/bench/bench_hooks.py`.

Nanoseconds of a question, with the view filled as the hook reads it and the call by its address,
the least of several turns: what an engine pays each time that it asks `send`. Then seconds to
compile a user's file, the first time and with what was kept; and a whole run with the built-in
policy that asks most, beside concurrent dataflow.
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from bench_engines import mountain5, run_s
from numpy.typing import NDArray

import simmpp
from simmpp.common.compiled import njit
from simmpp.engine.arrays.records import Run
from simmpp.engine.initial import new_state
from simmpp.engine.pe.peers import peer_of
from simmpp.engine.pe.showing import show_destination, view_of
from simmpp.policy import Policy
from simmpp.policy.record import consult
from simmpp.policy.view import View

CALLS, REPEATS = 2_000_000, 7


def all_that_waits(v: View) -> int:
    return v.waiting


def to_the_less_loaded(v: View) -> int:
    return v.waiting if v.load > v.min_load and v.load > v.known_load else 0


def with_the_clock(v: View) -> int:
    return v.waiting if v.load > v.known_load and v.now_ps > v.age_ps + v.held_bytes else 0


def with_a_memory(v: View) -> int:
    v.memory[0] += v.load - v.known_load
    return v.waiting if v.memory[0] > 0 else 0


def by_chance(v: View) -> int:
    return v.random % (v.waiting + 1)


def by_what_the_way_costs(v: View) -> int:
    return v.waiting if v.send_ps + v.receive_ps + v.flight_ps < v.load else 0


HOOKS: tuple[Callable[[View], int], ...] = (
    *(all_that_waits, to_the_less_loaded, with_the_clock, with_a_memory),
    *(by_chance, by_what_the_way_costs),
)


def main() -> None:
    """Print the tables."""
    case: Any = mountain5(64, 64)
    print("a question                ns")
    for hook in HOOKS:
        policy = simmpp.PolicyParameters(file=Policy("bench", send=hook))
        state = new_state(*case, policy, ready_order="depth-first")  # it holds the arrays
        runs = state.runs
        _ask(runs, 1000)
        times = [_seconds(lambda runs=runs: _ask(runs, CALLS)) for _ in range(REPEATS)]
        print(f"{hook.__name__:22} {min(times) / CALLS * 1e9:5.1f}")
    print("\na file of one's own       seconds to compile its two hooks")
    with tempfile.TemporaryDirectory() as folder:
        for how in ("first", "again"):
            done = subprocess.run(
                [sys.executable, "-c", COMPILE],
                env=os.environ | {"SIMMPP_CACHE": folder},
                cwd=folder,
                capture_output=True,
                text=True,
                check=True,
            )
            print(f"{how:22} {done.stdout.strip():>8}")
    print("\nMountain5, 64 PEs         seconds   questions' share is in the difference")
    case, first = mountain5(64, 256), math.nan
    for name in ("concurrent", "holders", "cost"):
        seconds = min(run_s("compiled", case, name)[0] for _ in range(REPEATS))
        first = seconds if math.isnan(first) else first
        print(f"{name:22} {seconds:8.3f} {seconds / first:6.2f}")


COMPILE = """
import time
from pathlib import Path
from simmpp.policy.file import policy_of_file, read_policy
from simmpp.policy.hooks import address_of
from simmpp.policy.parameters import POLICIES
from simmpp.studies.policies.beginning import beginning
Path("mine.py").write_text(beginning("mine"))
address_of(POLICIES["ray"].send)  # numba begins
began = time.process_time()
policy = policy_of_file(read_policy("mine.py"))
for hook in policy.hooks.values():
    address_of(hook, tuple(policy.parameters))
print(f"{time.process_time() - began:.3f}")
"""


def _seconds(call: Callable[[], object]) -> float:
    began_s = time.process_time()
    call()
    return time.process_time() - began_s


@njit
def _ask(runs: NDArray[np.void], n: int) -> int:
    """Ask about one PE so many times."""
    s: Run = runs[0]
    view, peer_row, total = view_of(s, 0), peer_of(s, 0, 1), 0
    for i in range(n):
        show_destination(s, view, 0, peer_row, i)
        total += consult(s.send, view)
    return total


if __name__ == "__main__":
    main()
