"""The step-by-step machine that the paper's analytical model describes, message by message.

All rays that are alive make one test per step; a barrier ends the step (Nebel 1998, section 3.1,
steps 3 to 6). In object dataflow each ray whose object is missing sends a request of its own; in
ray dataflow each PE sends one message to every other PE, with rays or without. The network takes no
time. Each PE has its own clock, advanced by the costs of one message, test or ray after the other.

A step counts its rays and messages between all pairs of PEs in dense arrays (nb, nb), as the
formulas do, so PEs are limited to MOST_PROCESSORS: at 4096 one such array takes 128 MiB.

Within a step the model lets no PE wait: a message is at hand when its receiver gets to it.
``waits`` makes the receiver wait until the message has been sent, which shows how much that
assumption hides.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError
from simmpp.machine.limits import CLOCK_LIMIT_PS, beyond_the_clock, total_compute_ps
from simmpp.machine.machine import Machine
from simmpp.machine.messages import OBJECT, RAYS, REQUEST
from simmpp.machine.transfer import transfer_ps
from simmpp.model.known import require_known
from simmpp.model.lockstep import steps_of
from simmpp.model.synchronous_step import World, needs, new_step, next_rays, object_step, ray_step
from simmpp.placement.placement import Placement
from simmpp.workload.workload import Workload

MOST_PROCESSORS = 4096
Dataflow = Literal["object", "ray"]
DATAFLOWS: tuple[Dataflow, ...] = ("object", "ray")


@dataclass(frozen=True, eq=False)
class SynchronousResult:
    """Times of a synchronous run, and the n and r that it had."""

    times_ps: NDArray[np.int64]
    """(K, nb) int64: what each PE worked (and waited for messages, with ``waits``) in each step."""
    counts: Counts

    @property
    def makespan_ps(self) -> int:
        """Every step takes as long as its slowest PE."""
        return int(self.times_ps.max(axis=1, initial=0).sum())


def synchronous(
    workload: Workload,
    machine: Machine,
    placement: Placement,
    dataflow: Dataflow,
    *,
    waits: bool = False,
) -> SynchronousResult:
    """Run a workload step by step.

    Raises ConfigError for more than MOST_PROCESSORS, off the torus, for islands, or if tests and
    messages may exceed the clock.
    """
    require_known(machine, workload)
    if placement.islands > 1:
        raise ConfigError("the formulas know no islands: expected placement.islands 1")
    _check_processors(machine.processors)
    _check_clock(workload, machine, dataflow)
    world, nb = _world(workload, machine, placement, waits), machine.processors
    alive = np.arange(workload.n_primaries, dtype=np.int32)
    step_of = object_step if dataflow == "object" else ray_step
    per_pe = [np.zeros((3, 0, nb), np.int64)]
    lacking = [np.zeros((4, 0), np.int64)]
    while len(alive):
        step = new_step(nb)
        step_of(world, step, alive, needs(world, step, alive))
        alive = next_rays(world, alive)
        lacking.append(_entries(step.r, len(lacking) - 1))
        per_pe.append(np.array([[step.clocks], [step.tests], [step.ended]]))
    times_ps, tests, ended = np.concatenate(per_pe, axis=1)
    counts = Counts(tests, ended, *np.concatenate(lacking, axis=1))
    return SynchronousResult(times_ps, counts)


def _entries(r: NDArray[np.int64], k: int) -> NDArray[np.int64]:
    """What ``Counts`` keeps of the r of step k: steps, holders, owners, rays, (4, entries)."""
    holders, owners = np.nonzero(r)
    return np.array([np.full(len(holders), k), holders, owners, r[holders, owners]], np.int64)


def _check_processors(nb: int) -> None:
    if nb > MOST_PROCESSORS:
        raise ConfigError(
            f"processors: {nb}, expected at most {MOST_PROCESSORS} where the machine runs step by "
            "step (analytical-measured): each step counts rays between all pairs of PEs"
        )


def _check_clock(workload: Workload, machine: Machine, dataflow: Dataflow) -> None:
    """Refuse what might wrap: all messages on one PE, each object as large as the largest."""
    nb, n_tests, n_steps = machine.processors, workload.n_tests, len(steps_of(workload).tests)
    startup_ps = float(machine.send_startup_ps + machine.receive_startup_ps)
    if dataflow == "object":
        sizes = {REQUEST: machine.request_bytes, OBJECT: workload.object_bytes.max(initial=0)}
        messages, rays = 2.0 * n_tests, 0
    else:
        sizes, messages, rays = {RAYS: 0}, float(n_steps) * nb * nb, n_tests
    copies_ps = sum(_copies_ps(machine, kind, int(size)) for kind, size in sizes.items())
    moved_ps = rays * float(_copies_ps(machine, RAYS, machine.ray_bytes))
    messages_ps = messages * (startup_ps + copies_ps) + moved_ps
    if total_compute_ps(workload, machine) + messages_ps > CLOCK_LIMIT_PS:
        raise beyond_the_clock()


def _copies_ps(machine: Machine, kind: int, n_bytes: int) -> int:
    """Packing and unpacking of one message."""
    both = (machine.pack[kind], machine.unpack[kind])
    return sum(cost.fixed_ps + transfer_ps(n_bytes, cost.bytes_per_s) for cost in both)


def _world(workload: Workload, machine: Machine, placement: Placement, waits: bool) -> World:
    def copies(costs: Any) -> NDArray[np.int64]:
        return np.array([(cost.fixed_ps, cost.bytes_per_s) for cost in costs], np.int64)

    pe_of = np.zeros(workload.n_rays, np.int32)
    pe_of[: workload.n_primaries] = placement.pixel_pes
    return World(
        workload.itinerary_offsets,
        workload.itinerary_objects,
        workload.child_offsets,
        placement.owners,
        _residency(placement),
        workload.object_bytes,
        machine.test.of_objects(workload),
        machine.send_startup_ps,
        machine.receive_startup_ps,
        machine.ray_ps,
        copies(machine.pack),
        copies(machine.unpack),
        machine.request_bytes,
        machine.ray_bytes,
        waits,
        workload.itinerary_offsets[:-1].copy(),
        pe_of,
    )


def _residency(placement: Placement) -> NDArray[np.bool_]:
    nb, n_objects = placement.processors, len(placement.owners)
    resident = np.zeros((nb, n_objects), np.bool_)
    resident[placement.owners, np.arange(n_objects)] = True
    holders = np.repeat(np.arange(nb), np.diff(placement.replica_offsets))
    resident[holders, placement.replica_objects] = True
    return resident


# --- what a step-by-step run is made of: the paper's n(i, k) and r(i, j, k) ---


@dataclass(frozen=True, eq=False)
class Counts:
    """Rays on each PE i at each of K steps, and which of them lack an object.

    r is kept sparse, as M entries other than 0, for it has K nb^2.
    """

    tests: NDArray[np.int64]
    """(K, nb) int64: n(i, k), rays that PE i tests at step k."""
    ended: NDArray[np.int64]
    """(K, nb) int64: rays deleted on PE i at step k."""
    steps: NDArray[np.int64]
    """(M,) int64: k of each entry of r."""
    holders: NDArray[np.int64]
    """(M,) int64: i, where the rays are when the step begins."""
    owners: NDArray[np.int64]
    """(M,) int64: j, who owns the objects that they lack."""
    rays: NDArray[np.int64]
    """(M,) int64: r(i, j, k), i != j."""

    def missing_by_holder(self) -> NDArray[np.int64]:
        """The sum of r(i, j, k) over j != i: (K, nb) int64."""
        return self._summed(self.holders)

    def missing_by_owner(self) -> NDArray[np.int64]:
        """The sum of r(j, i, k) over j != i: (K, nb) int64."""
        return self._summed(self.owners)

    def _summed(self, pes: NDArray[np.int64]) -> NDArray[np.int64]:
        total = np.zeros_like(self.tests)
        np.add.at(total, (self.steps, pes), self.rays)
        return total
