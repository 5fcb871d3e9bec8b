"""The state of a run at time 0: the room it needs, what is given, whose the primary rays are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit
from simmpp.engine.arrays.layout import (
    ARRAYS,
    BINS,
    COPY,
    LOAD_INFO,
    NONE,
    PARAMETERS,
    PIGGYBACK,
    SIZES,
    Run,
)
from simmpp.engine.arrays.views import pes, rays
from simmpp.engine.record.counters import first_width
from simmpp.engine.record.log import LOG_ROWS, Sink
from simmpp.engine.residency import Arrays, resident_arrays, resident_bytes, row_bytes
from simmpp.engine.state import State
from simmpp.machine.limits import CLOCK_LIMIT_PS
from simmpp.machine.machine import Machine
from simmpp.machine.messages import MESSAGE_KINDS
from simmpp.machine.torus import LINKS, ROWS_PER_PE
from simmpp.placement.placement import Placement
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.registry import POLICIES
from simmpp.workload.workload import Workload


def new_state(
    workload: Workload,
    machine: Machine,
    placement: Placement,
    parameters: PolicyParameters,
    *,
    ready_order: str,
    record_tests: bool,
    record_counters: bool = False,
    record_hops: bool = False,
    log: Sink | None = None,
) -> State:
    """The state at time 0: all primary rays of its pixels are ready on each PE."""
    everything = POLICIES[parameters.name].all_resident
    n_recorded = workload.n_tests if record_tests else 0
    arrays = _own_arrays(workload, placement, parameters, n_recorded, logs=log is not None)
    arrays |= _counting_arrays(placement.processors if record_counters else 0)
    arrays |= resident_arrays(workload, placement, everything)
    arrays |= _given_arrays(workload, machine, placement)
    flags = {
        "depth_first": ready_order == "depth-first",
        "record_tests": record_tests,
        "record_counters": record_counters,
        "record_hops": record_hops,
        "bin_width": first_width(_least_ps(workload, machine)),
        "logs": log is not None,
    }
    state = State(arrays, _parameters(workload, machine, placement, parameters) | flags, log)
    state.pes["held_bytes"] = resident_bytes(workload, placement, everything)
    _deal(state.runs, placement.pixel_pes)
    if record_counters:
        state.arrays["slices"]["load"] = state.pes["load"]
    return state


def _least_ps(workload: Workload, machine: Machine) -> int:
    """No run takes less: all rays, and all tests as if of the cheapest object, on all PEs."""
    test_ps = int(machine.test.of_objects(workload).min(initial=CLOCK_LIMIT_PS))
    total_ps = workload.n_rays * machine.ray_ps + workload.n_tests * test_ps
    return total_ps // machine.processors


def _given_arrays(workload: Workload, machine: Machine, placement: Placement) -> Arrays:
    n_links = ROWS_PER_PE * machine.processors if machine.contention == LINKS else 0
    costs = [(cost.fixed_ps, cost.bytes_per_s) for cost in (*machine.pack, *machine.unpack)]
    return {
        "itinerary_offsets": workload.itinerary_offsets,
        "itinerary_objects": workload.itinerary_objects,
        "child_offsets": workload.child_offsets,
        "object_bytes": workload.object_bytes,
        "test_ps": machine.test.of_objects(workload),
        "owners": placement.owners,
        "copy_costs": np.array(costs, COPY),
        "free_ps": np.zeros(n_links, np.int64),
    }


def _counting_arrays(nb: int) -> Arrays:
    sizes = {
        "compute_bins": nb * BINS,
        "communication_bins": nb * BINS,
        "moments": BINS,
        "traffic": nb * nb,
        "sizes": len(MESSAGE_KINDS) * SIZES,
        "slices": nb,
    }
    return {name: np.zeros(size if nb else 0, ARRAYS[name]) for name, size in sizes.items()}


def _own_arrays(
    workload: Workload,
    placement: Placement,
    parameters: PolicyParameters,
    n_recorded: int,
    *,
    logs: bool,
) -> Arrays:
    nb, n_objects, n_rays = placement.processors, workload.n_objects, workload.n_rays
    n_wants = 1 + min(nb * n_objects, n_rays + nb * (placement.transient + 1))
    n_partners = 1 + min(nb * nb, 2 * workload.n_tests)
    # One step sends at most a request per object (per ray, unmerged), a batch and a load per PE.
    most_sent = (n_objects if parameters.merge_requests else n_rays) + 2 * nb + 1
    sizes = {
        "sent_by_kind": 4,
        "pes": nb,
        "rays": n_rays,
        "wants": n_wants,
        "wants_buckets": _power_of_two(n_wants),
        "partners": n_partners,
        "partners_buckets": _power_of_two(n_partners),
        "messages": min(most_sent, n_objects + 2 * nb + 1),
        "unasked_ends": 4 * nb,
        "unasked_links": 2 * n_wants,
        "recent_ends": 2 * nb,
        "recent_links": 2 * n_wants,
        "unsent_ends": 4 * nb,
        "unsent_links": 2 * n_partners,
        "exchanged_ends": 2 * nb,
        "exchanged_links": 2 * n_partners,
        "sendable_ends": 2 * n_partners,
        "sendable_links": 2 * n_wants,
        "outbox": most_sent,
        "sort_keys": max(n_objects, nb),
        "sort_items": max(n_objects, nb),
        "tested_rays": n_recorded,
        "tested_objects": n_recorded,
        "log": 2 * LOG_ROWS + most_sent if logs else 0,
    }
    arrays = {name: np.zeros(size, ARRAYS[name]) for name, size in sizes.items()}
    marks = ("wants_marks", "partners_marks", "messages_marks")
    return arrays | {name: np.array([NONE, 0], np.int32) for name in marks}


def _power_of_two(n: int) -> int:
    return 1 << max(4, (n - 1).bit_length())


def _parameters(
    workload: Workload, machine: Machine, placement: Placement, parameters: PolicyParameters
) -> dict[str, int]:
    policy = POLICIES[parameters.name]
    nb, n0, min_load = machine.processors, workload.n_primaries, parameters.min_load
    load_info, refresh_ps = LOAD_INFO[parameters.load_info], parameters.refresh_ps
    listens = policy.knows_loads and load_info == PIGGYBACK
    limits = [b for b in (machine.link_bytes_per_s, machine.injection_bytes_per_s) if b]
    x, y, z = machine.shape
    return {name: getattr(machine, name) for name in PARAMETERS if hasattr(machine, name)} | {
        "x": x,
        "y": y,
        "z": z,
        "n_objects": workload.n_objects,
        "bytes_per_s": min(limits, default=0),
        "contends": machine.contention == LINKS,
        "transient": placement.transient,
        "row_bytes": row_bytes(placement, workload.n_objects),
        "all_resident": policy.all_resident,
        "sends": policy.sends,
        "asks": policy.asks,
        "may_send": policy.may_send.address,
        "may_ask": policy.may_ask.address,
        # A load is an integer: it exceeds a fraction exactly if it exceeds its floor.
        "min_load": min_load if isinstance(min_load, int) else int(min_load * n0 // nb),
        "initial_load": n0 // nb,
        "batch": parameters.batch,
        "ask_at_least": policy.ask_at_least or parameters.ask_at_least,
        "load_info": load_info,
        "listens": listens,
        "refresh_ps": NONE if refresh_ps is None or not listens else refresh_ps,
        "merge_requests": parameters.merge_requests,
    }


@njit
def _deal(runs: NDArray[np.void], pixel_pes: NDArray[np.int32]) -> None:
    """Make primary rays ready on the PEs of their pixels, in pixel order."""
    s: Run = runs[0]
    for me in range(s.processors):
        pes(s)[me].ready_first = NONE
        pes(s)[me].ready_last = NONE
    for ray in range(pixel_pes.size):
        pe = pes(s)[pixel_pes[ray]]
        rays(s)[ray].next = NONE
        if pe.ready_first == NONE:
            pe.ready_first = ray
        else:
            rays(s)[pe.ready_last].next = ray
        pe.ready_last = ray
        pe.n_ready += 1
    for me in range(s.processors):
        pe = pes(s)[me]
        pe.load = pe.n_ready
        pe.settled_load = pe.n_ready
        pe.peak_rays = pe.n_ready
        pe.peak_object_bytes = pe.held_bytes
        pe.peak_bytes = pe.held_bytes + pe.n_ready * s.ray_bytes
    s.rays_left = pixel_pes.size
