"""The model's formulas fed with the n and r of a real workload on a real placement."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.machine.machine import CopyCost, Machine
from simmpp.machine.messages import RAYS
from simmpp.machine.transfer import transfer_ps
from simmpp.model.costs import Costs, costs_of
from simmpp.model.formulas import makespan, object_dataflow_ps, ray_dataflow_ps
from simmpp.model.synchronous import Counts, Dataflow, synchronous
from simmpp.placement.placement import Placement
from simmpp.workload.workload import Workload

Ints = NDArray[np.int64]


class Measured(NamedTuple):
    """What the formulas say of one dataflow on a placement."""

    makespan_ps: int
    """To the nearest picosecond."""
    lacking: int
    """The sum of all r: rays that lacked the object of a test."""
    steps: int
    """K."""


def measured(
    workload: Workload, machine: Machine, placement: Placement, dataflow: Dataflow
) -> Measured:
    """The formulas fed with n and r counted by moving every ray step by step.

    The costs of a test and of an object are the workload's means.
    """
    counts = synchronous(workload, machine, placement, dataflow).counts
    times = step_times_ps(counts, dataflow, machine, costs_of(machine, workload))
    return Measured(round(float(makespan(times))), int(counts.rays.sum()), len(counts.tests))


def step_times_ps(
    counts: Counts, dataflow: Dataflow, machine: Machine, costs: Costs
) -> NDArray[np.int64] | NDArray[np.float64]:
    """TC(i, k) or TO(i, k) from n and r: (K, nb).

    Whole costs give int64 and the exact picoseconds of a run: a message of r rays is then packed in
    the machine's time for r rays, rounded once, where the paper has r T_pack_ray.
    """
    costs = _whole(costs)
    asked, served = counts.missing_by_holder(), counts.missing_by_owner()
    if dataflow == "object":
        return object_dataflow_ps(costs, counts.tests, counts.ended, asked, served)
    messages = machine.processors - 1
    packing = _packing_ps(counts, machine)
    return ray_dataflow_ps(costs, counts.tests, counts.ended, messages, packing)


def _whole(costs: Costs) -> Costs:
    """Costs that are whole numbers as integers, so that sums of them are exact."""
    values = {name: int(value) for name, value in vars(costs).items() if value == int(value)}
    return replace(costs, **values)


def _packing_ps(counts: Counts, machine: Machine) -> Ints:
    """What each PE packs and unpacks at each step, messages without rays included: (K, nb)."""
    pack, unpack = machine.pack[RAYS], machine.unpack[RAYS]
    total = np.full_like(counts.tests, (machine.processors - 1) * (pack.fixed_ps + unpack.fixed_ps))
    n_bytes = counts.rays * machine.ray_bytes
    np.add.at(total, (counts.steps, counts.holders), _transfer_ps(pack, n_bytes))
    np.add.at(total, (counts.steps, counts.owners), _transfer_ps(unpack, n_bytes))
    return total


def _transfer_ps(cost: CopyCost, n_bytes: Ints) -> Ints:
    """The time of each message's bytes, each size worked out once."""
    sizes, which = np.unique(n_bytes, return_inverse=True)
    times = [transfer_ps(size, cost.bytes_per_s) for size in sizes.tolist()]
    return np.array(times, np.int64)[which]
