"""Rounds at the start of a run: which rays are of which, and whose roots begin at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from simmpp.engine.arrays.records import NONE, ROUND
from simmpp.engine.residency import Arrays
from simmpp.machine.collective import barrier_ps, messages_of
from simmpp.machine.machine import Machine
from simmpp.placement.placement import Placement
from simmpp.workload.workload import FORM_FACTOR, Workload

if TYPE_CHECKING:  # who only reads results needs no numba
    from simmpp.engine.state import State


def round_arrays(workload: Workload, placement: Placement) -> Arrays:
    """``pixels`` by PE and round, and what is known of the rounds; of a single one, nothing."""
    if workload.n_rounds == 1:
        return {
            "pixels": np.argsort(placement.pixel_pes, kind="stable"),
            "ray_rounds": np.zeros(0, np.int32),
            "rounds": np.zeros(0, ROUND),
        }
    rounds = np.zeros(workload.n_rounds, ROUND)
    rounds["left"] = np.bincount(workload.root_rounds)
    rounds["begin_ps"][placement.window :] = NONE
    return {
        "pixels": np.lexsort((workload.root_rounds, placement.pixel_pes)),
        "ray_rounds": workload.root_rounds[workload.pixels],
        "rounds": rounds,
    }


def round_scalars(workload: Workload, machine: Machine, placement: Placement) -> dict[str, int]:
    """What is the same for all PEs."""
    return {
        "n_rounds": workload.n_rounds,
        "window": placement.window,
        "barrier_ps": barrier_ps(machine),
        "choosing_ps": barrier_ps(machine) if chooses(workload) else 0,
        "next_round": placement.window,
    }


def chooses(workload: Workload) -> bool:
    """Does each round begin with a maximum over all PEs? So it does where patches shoot in turn."""
    n0 = workload.n_primaries
    return workload.n_rounds > 1 and bool((workload.kinds[:n0] == FORM_FACTOR).any())


def roots_at_once(workload: Workload, window: int) -> int:
    """Roots that are there together, in the mean of rounds: n0 of a single one."""
    return workload.n_primaries * min(window, workload.n_rounds) // workload.n_rounds


def first_roots(workload: Workload, placement: Placement) -> NDArray[np.int64]:
    """Roots of each PE that are of the rounds which begin at once: (nb,)."""
    pes = placement.pixel_pes
    if workload.n_rounds > 1:
        pes = pes[workload.root_rounds < placement.window]
    return np.bincount(pes, minlength=placement.processors)


def barriers(state: State, workload: Workload, machine: Machine) -> tuple[int, int, int]:
    """How many there were, the time of all, and their messages, reductions included."""
    began = int((state.arrays["rounds"]["begin_ps"] != NONE).sum())
    n = max(0, began - state["window"])
    return n, n * barrier_ps(machine), n * messages_of(machine) * (1 + chooses(workload))


def round_ends(state: State) -> NDArray[np.int64]:
    """When the last ray of each round was finished: (rounds,); NONE of one that is not over."""
    rounds = state.arrays["rounds"]
    if len(rounds) == 0:
        return np.array([NONE if state["rays_left"] else state["last_ray_ps"]])
    return np.where(rounds["left"] == 0, rounds["end_ps"], NONE)
