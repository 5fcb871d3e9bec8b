"""What a PE's memory is for: the least with which a policy runs, and how a capacity is split.

    capacity = own objects + replicas                     for good
             + control                                    one request of each other PE
             + escape                                     the largest object that is not resident
             + receive                                    a share for the rays of each other PE
             + fetch                                      objects asked for, in use, kept
             + queue                                      rays

Receive and fetch are wishes (``Capacity.buffers``, ``Capacity.fetch``): they get what they want of
what is left beside the rays of the largest tree, the queue has the remainder. So what fits into a
capacity fits into every larger one. With ``memory.fraction: fill`` there are no replicas in this
sum, and the escape is for the largest object that is not the PE's own; the queue is a quarter of
what is left, or the largest tree, and replicas have the remainder.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit
from simmpp.common.errors import ConfigError
from simmpp.common.units import counted, format_bytes, shown, write_bytes
from simmpp.engine.residency import resident_bytes
from simmpp.engine.tables.tallies import copy_bytes
from simmpp.machine.machine import POLLED, Machine
from simmpp.placement.placement import Placement
from simmpp.placement.rooms import LEAST, Capacity, Room
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload

Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Needs:
    """Bytes that a policy needs on the PEs, whatever their capacity."""

    resident: Ints
    """(nb,) int64: own objects and replicas, and a copy of all tallies where these are reduced."""
    escape: Ints
    """(nb,) int64: the largest object that is not resident; 0 where nothing can ask."""
    control: int
    """One request of each other PE; 0 where nothing can ask."""
    tree: int
    """The rays of the largest tree: the most of one pixel's that can be alive at once."""
    receive: int
    """One ray, with a header, of each other PE; 0 where nothing is sent."""
    sends: bool
    """Rays are sent."""
    asks: bool
    """Objects are asked for, other than to escape."""
    most_alive: NDArray[np.int32]
    """(n,) int32: the most rays that can be alive at once of a ray and all that it brings forth."""
    fills: bool
    """Replicas take what is left: of these nothing is in ``resident`` and ``escape``."""
    replicas: Ints | int = 0
    """(nb,) int64: what these are, once they are dealt."""

    @property
    def permanent(self) -> Ints:
        """(nb,) int64: what is never free."""
        return self.resident + self.escape + self.control

    @property
    def least_bytes(self) -> int:
        """The least capacity."""
        return int(self.permanent.max()) + self.tree + self.receive


@dataclass(frozen=True, eq=False)
class Split:
    """The parts of a capacity that are for rays and fetched objects, on each PE: (nb,) int64."""

    receive: Ints
    fetch: Ints
    queue: Ints
    replicas: Ints
    """0, but where these take what the others leave."""


def needs_of(
    workload: Workload, machine: Machine, placement: Placement, policy: PolicyParameters
) -> Needs:
    """What a policy needs on each PE of a placement."""
    rules, nb, bounds = policy.rules, placement.processors, placement.capacity
    resident = resident_bytes(workload, placement, rules.all_resident)
    resident = resident + copy_bytes(workload, placement)
    largest = _largest_lacking(workload, placement, rules.all_resident)
    lacks, others = bool((largest >= 0).any()), placement.island - 1
    escapes = bounds is not None and bounds.has_escape
    can_ask = lacks and (rules.asks or escapes)
    header_bytes, ray_bytes, alive = machine.header_bytes, machine.ray_bytes, most_alive(workload)
    return Needs(
        resident=resident,
        escape=np.maximum(largest, 0) if lacks and escapes else np.zeros(nb, np.int64),
        control=others * (header_bytes + machine.request_bytes) if can_ask else 0,
        tree=ray_bytes * int(alive[: workload.n_primaries].max(initial=0)),
        receive=others * (header_bytes + ray_bytes) if lacks and rules.sends else 0,
        sends=lacks and rules.sends,
        asks=lacks and rules.asks,
        most_alive=alive,
        fills=lacks and placement.filling is not None,
    )


def capacity_bytes(bounds: Capacity, needs: Needs) -> int:
    """The capacity as a number of bytes."""
    return needs.least_bytes if bounds.bytes == LEAST else bounds.bytes


def require_room(
    workload: Workload, machine: Machine, placement: Placement, policy: PolicyParameters
) -> Needs | None:
    """What a policy needs, or None where memory has no end.

    Raises ConfigError if it can't run in the capacity, with the least that would do.
    """
    bounds, nb = placement.capacity, placement.island
    if bounds is None:
        return None
    if problem := clash(machine, policy):
        raise ConfigError(f"memory.capacity: {problem}")
    needs, scene = needs_of(workload, machine, placement, policy), int(workload.object_bytes.sum())
    if fits(needs, placement, scene):
        return needs
    given = capacity_bytes(bounds, needs)
    problem = f"value {shown(write_bytes(given))}"
    if nb * given < scene:
        problem += f", which is less on {counted(nb, 'PE')} than the scene's {format_bytes(scene)}"
    least = f"expected at least {write_bytes(needs.least_bytes)} for {policy.title}"
    raise ConfigError(f"memory.capacity: {problem}: {least}")


def clash(machine: Machine, policy: PolicyParameters) -> str:
    """What can't be combined with a capacity, or nothing."""
    if policy.rules.asks and not policy.merge_requests:
        return f"expected merge_requests: true beside it, for {policy.title}"
    if machine.service != POLLED:
        return f"expected machine.service {POLLED} beside it, got {machine.service}"
    return ""


def fits(needs: Needs, placement: Placement, scene_bytes: int) -> bool:
    """Is the capacity enough for a policy to run in?

    With ``flow: none`` it is only compared with what is held, but all PEs of an island together
    have to hold the scene.
    """
    return lacking(needs, placement, scene_bytes) == 0


def lacking(needs: Needs, placement: Placement, scene_bytes: int) -> int:
    """By how many bytes a capacity is too small for a policy to run in; 0 if it ``fits``."""
    bounds = placement.capacity
    if bounds is None:
        return 0
    least = needs.least_bytes if bounds.has_credits else 0
    scene_part = -(-scene_bytes // placement.island)
    return max(0, max(least, scene_part) - capacity_bytes(bounds, needs))


def split(needs: Needs, bounds: Capacity, total_bytes: int) -> Split:
    """How PEs use a capacity that is large enough."""
    parts: list[tuple[int, int, int, int]] = []
    for permanent in needs.permanent.tolist():
        rest, receive, fetch = total_bytes - permanent, 0, 0
        queue = _queue_that_is_kept(needs, rest)
        if needs.sends:
            receive = max(needs.receive, min(_wish(bounds.buffers, rest), rest - queue))
        if needs.asks:
            fetch = min(_wish(bounds.fetch, rest), rest - queue - receive)
        left = rest - receive - fetch
        queue = queue if needs.fills else left
        parts.append((receive, fetch, queue, left - queue))
    return Split(*np.array(parts, np.int64).reshape(-1, 4).T)


def _queue_that_is_kept(needs: Needs, rest: int) -> int:
    """What nothing else takes from the rays: the largest tree; a quarter where replicas take all
    that is left, as far as the least room for rays that arrive allows."""
    return max(needs.tree, min(rest // 4, rest - needs.receive)) if needs.fills else needs.tree


def _wish(wish: Fraction | Room, rest: int) -> int:
    return wish.bytes if isinstance(wish, Room) else int(wish * rest)


def most_alive(workload: Workload) -> NDArray[np.int32]:
    """How many of a ray's tree can be alive at once, for each.

    A ray that waits lets others run on, so all leaves of its tree may be there at the same time.
    """
    most = np.ones(workload.n_rays, np.int32)
    _add_children(workload.child_offsets, most)
    return most


@njit
def _add_children(child_offsets: NDArray[np.int32], most: NDArray[np.int32]) -> None:
    """Fill ``most``, whose entries are 1, from the last ray on: children come after parents."""
    for ray in range(most.size - 1, -1, -1):
        total = 0
        for child in range(child_offsets[ray], child_offsets[ray + 1]):
            total += most[child]
        most[ray] = max(1, total)


def _largest_lacking(workload: Workload, placement: Placement, everything: bool) -> Ints:
    """(nb,) int64: bytes of the largest object that each PE lacks; -1 if it lacks none."""
    largest = np.full(placement.processors, -1, np.int64)
    if not everything:
        _find_lacking(
            np.argsort(-workload.object_bytes, kind="stable"),
            workload.object_bytes,
            placement.owners,
            placement.island,
            placement.replica_offsets,
            placement.replica_objects,
            np.full(workload.n_objects, -1, np.int32),
            largest,
        )
    return largest


@njit
def _find_lacking(
    largest_first: Ints,
    object_bytes: Ints,
    owners: NDArray[np.int32],
    island: int,
    replica_offsets: Ints,
    replica_objects: NDArray[np.int32],
    last_holder: NDArray[np.int32],
    largest: Ints,
) -> None:
    """Fill ``largest``; ``last_holder`` is room for the PE that was last seen to hold an object."""
    for pe in range(largest.size):
        for at in range(replica_offsets[pe], replica_offsets[pe + 1]):
            last_holder[replica_objects[at]] = pe
        for obj in largest_first:
            if owners[obj] != pe % island and last_holder[obj] != pe:
                largest[pe] = object_bytes[obj]
                break
