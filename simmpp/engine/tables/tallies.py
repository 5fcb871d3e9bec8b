"""The tallies of objects in a run: what is sent of them, and what adding them up takes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from simmpp.engine.residency import Arrays
from simmpp.machine.collective import all_reduce_ps, messages_of
from simmpp.machine.machine import Machine
from simmpp.placement.placement import Placement
from simmpp.workload.tallies import leaving
from simmpp.workload.workload import Workload


def sends_deposits(workload: Workload, placement: Placement) -> bool:
    """Do tests leave something that its owner has to be sent?"""
    return placement.tallies == "send" and bool(workload.object_results.any())


def deposit_arrays(workload: Workload, placement: Placement) -> Arrays:
    """Which tests leave a deposit; empty where nothing is sent of them."""
    sends = sends_deposits(workload, placement)
    return {"leaves": leaving(workload) if sends else np.zeros(0, np.uint8)}


def copy_bytes(workload: Workload, placement: Placement) -> int:
    """What the tallies of all objects take on every PE."""
    if placement.tallies != "reduce" or placement.processors == 1:
        return 0
    return int(workload.object_results.sum())


class Reduction(NamedTuple):
    """What it takes to add up the copies of all PEs, when the last ray is finished."""

    time_ps: int = 0
    messages: int = 0
    n_bytes: int = 0
    """Of these messages, with headers."""


def reduction_of(workload: Workload, machine: Machine, placement: Placement) -> Reduction:
    """Of a run; nothing where there are no copies."""
    each = copy_bytes(workload, placement)
    if each == 0:
        return Reduction()
    messages = messages_of(machine)
    n_bytes = messages * (machine.header_bytes + each)
    return Reduction(all_reduce_ps(machine, each), messages, n_bytes)
