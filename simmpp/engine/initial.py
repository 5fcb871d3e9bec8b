"""The state of a run at time 0: the room it needs, what is given, whose the primary rays are."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from simmpp.common.randomness import key
from simmpp.engine.arrays.layout import MACHINE, allocated
from simmpp.engine.arrays.records import (
    COPY,
    EXACT,
    LOAD_INFO,
    NONE,
    PACKING,
    PIGGYBACK,
    SAMPLED,
    SERVICE,
)
from simmpp.engine.bounds import room_arrays
from simmpp.engine.capacity import Needs
from simmpp.engine.pe.pace import noise_array, pace_columns, pace_scalars
from simmpp.engine.record.counters import first_width
from simmpp.engine.record.recording import NOTHING, Recording
from simmpp.engine.residency import (
    Arrays,
    holder_arrays,
    resident_arrays,
    resident_bytes,
    row_bytes,
)
from simmpp.engine.sizes import sizes_of
from simmpp.engine.state import State
from simmpp.engine.tables.rounds import first_roots, roots_at_once, round_arrays, round_scalars
from simmpp.engine.tables.tallies import deposit_arrays
from simmpp.machine.limits import least_ps
from simmpp.machine.machine import Machine
from simmpp.machine.service import copies
from simmpp.machine.topology import network_of, topology_of
from simmpp.machine.torus import LINKS
from simmpp.placement.placement import Placement
from simmpp.policy.hooks import address_of
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.policy import Hook, Policy
from simmpp.policy.reads import groups_read, reads
from simmpp.policy.record import VIEW
from simmpp.policy.view import NUMBERS
from simmpp.workload.workload import Workload

AddressOf = Callable[[Hook | None, tuple[str, ...]], int]
"""Where a hook of a policy with these numbers of its own can be called."""


def new_state(
    workload: Workload,
    machine: Machine,
    placement: Placement,
    parameters: PolicyParameters,
    *,
    needs: Needs | None = None,
    ready_order: str,
    seed: int = 0,
    recording: Recording = NOTHING,
    address_of: AddressOf = address_of,
) -> State:
    """The state at time 0: all primary rays of its pixels are ready on each PE."""
    policy = parameters.rules
    everything = policy.all_resident
    arrays = allocated(sizes_of(workload, placement, parameters, recording))
    arrays |= resident_arrays(workload, placement, everything)
    arrays |= _given_arrays(workload, machine, placement)
    arrays |= round_arrays(workload, placement) | deposit_arrays(workload, placement)
    arrays |= room_arrays(placement, machine, needs)
    wants_holders = policy.to_holders or reads(policy, "holders")
    arrays |= holder_arrays(workload, placement, wanted=wants_holders)
    arrays["policy_views"] = views = _policy_views(workload, placement, parameters)
    flags = {
        "depth_first": ready_order == "depth-first",
        "record_tests": recording.tests,
        "record_counters": recording.counters,
        "record_hops": recording.hops,
        "record_ends": recording.ends,
        "bin_width": first_width(least_ps(workload, machine)),
        "logs": recording.sink is not None,
    }
    scalars = {name: getattr(machine, name) for name in MACHINE}
    scalars |= _of_the_run(workload, machine, placement)
    scalars |= round_scalars(workload, machine, placement)
    scalars |= _of_the_policy(parameters, views, address_of)
    scalars |= {"random_key": key(seed, "policy"), **pace_scalars(machine, seed)}
    if scalars["bounded"]:
        scalars["least_share"] = int(arrays["rooms"]["share_rays"].min())
    state = State(arrays, scalars | flags, recording.sink)
    for name, of_pes in pace_columns(machine).items():
        state.pes[name] = of_pes
    state.pes["held_bytes"] = resident_bytes(workload, placement, everything)
    _deal(state, workload, placement)
    if recording.counters:
        state.arrays["slices"]["load"] = state.pes["load"]
    return state


def _given_arrays(workload: Workload, machine: Machine, placement: Placement) -> Arrays:
    topology = topology_of(machine)
    pack, unpack = copies(machine)
    costs = [(cost.fixed_ps, cost.bytes_per_s) for cost in (*pack, *unpack)]
    return {
        "itinerary_offsets": workload.itinerary_offsets,
        "itinerary_objects": workload.itinerary_objects,
        "child_offsets": workload.child_offsets,
        "object_bytes": workload.object_bytes,
        "test_ps": machine.test.of_objects(workload),
        "test_scales": workload.ray_test_scales,
        "owners": placement.owners,
        "copy_costs": np.array(costs, COPY),
        "noise_factors": noise_array(machine),
        "topology": network_of(topology),
        "free_ps": np.zeros(topology.n_links if machine.contention == LINKS else 0, np.int64),
    }


def _policy_views(
    workload: Workload, placement: Placement, parameters: PolicyParameters
) -> NDArray[np.void]:
    """(1,) VIEW with what stays as it is in it; (nb,) for a policy with a memory."""
    nb = placement.processors
    views = np.zeros(nb if _remembers(parameters.rules) else 1, VIEW)
    views["nb"], views["initial_load"] = placement.island, _start_load(workload, placement)
    for name in NUMBERS:
        views[name] = _in_rays(getattr(parameters, name), workload, placement)
    own = parameters.numbers
    views["parameter"][:, : len(own)] = own
    return views


def _remembers(policy: Policy) -> bool:
    return reads(policy, "memory")


def _in_rays(number: Fraction | int, workload: Workload, placement: Placement) -> int:
    """A share of n0 / nb as a number of rays; n0 are the roots that are there together.

    A load is an integer: it exceeds a fraction exactly if it exceeds its floor.
    """
    if isinstance(number, int):
        return number
    return int(number * roots_at_once(workload, placement.window) // placement.processors)


def _start_load(workload: Workload, placement: Placement) -> int:
    """What is known of a PE before it is heard: its part of the roots that are there together."""
    return roots_at_once(workload, placement.window) // placement.processors


def _of_the_run(workload: Workload, machine: Machine, placement: Placement) -> dict[str, int]:
    bounds = placement.capacity
    return {
        "processors": machine.processors,
        "island": placement.island,
        "n_objects": workload.n_objects,
        "contends": machine.contention == LINKS,
        "service": SERVICE[machine.service],
        "measures": bounds is not None,
        "bounded": bounds is not None and bounds.has_credits,
        "escapes": bounds is not None and bounds.has_escape,
        "keeps": placement.transient > 0 or placement.transient_bytes > 0,
        "transient": placement.transient,
        "transient_bytes": placement.transient_bytes,
        "row_bytes": row_bytes(placement, workload.n_objects),
        "initial_load": _start_load(workload, placement),
    }


def _of_the_policy(
    parameters: PolicyParameters, views: NDArray[np.void], address_of: AddressOf
) -> dict[str, int]:
    policy = parameters.rules
    load_info, refresh_ps = LOAD_INFO[parameters.load_info], parameters.refresh_ps
    listens = parameters.knows_loads and load_info == PIGGYBACK
    names = tuple(policy.parameters)

    def count(of: int | str) -> int:
        """A number, or the number so called."""
        if isinstance(of, str):
            of = parameters.numbers[names.index(of)] if of in names else int(views[of][0])
        return max(of, 1)

    return {
        "all_resident": policy.all_resident,
        "sends": policy.sends,
        "asks": policy.asks,
        "send": address_of(policy.send, names),
        "ask": address_of(policy.ask, names),
        "keep": address_of(policy.keep, names),
        "heard": address_of(policy.heard, names),
        "idle": address_of(policy.idle, names),
        "talks": policy.talks,
        "steals": parameters.steals,
        "send_from": count(policy.batch),
        "ask_from": count(policy.ask_at_least),
        "send_reads": groups_read(policy.send),
        "ask_reads": groups_read(policy.ask),
        "keep_reads": groups_read(policy.keep),
        "heard_reads": groups_read(policy.heard),
        "idle_reads": groups_read(policy.idle),
        "remembers": _remembers(policy),
        "to_holders": policy.to_holders,
        "load_info": EXACT if load_info == SAMPLED and parameters.sample_ps == 0 else load_info,
        "listens": listens,
        "refresh_ps": NONE if refresh_ps is None or not listens else refresh_ps,
        "sample_ps": parameters.sample_ps or 0,
        "next_sample_ps": parameters.sample_ps or 0,
        "merge_requests": parameters.merge_requests,
        "deposits_from": parameters.batch,
        "packing": PACKING[parameters.packing],
    }


def _deal(state: State, workload: Workload, placement: Placement) -> None:
    """Give primary rays to the PEs of their pixels, in pixel order; later rounds are not there."""
    n_all = np.bincount(placement.pixel_pes, minlength=placement.processors)
    n_pixels = first_roots(workload, placement)
    pes, ends = state.pes, np.cumsum(n_all)
    pes["first"] = pes["in_hand"] = NONE
    pes["place"] = np.arange(placement.processors) % placement.island
    pes["base"] = np.arange(placement.processors) - pes["place"]
    pes["spell"] = 1
    pes["pixel"], pes["pixel_end"] = ends - n_all, ends - n_all + n_pixels
    pes["later"], pes["later_end"], pes["round"] = pes["pixel_end"], ends, placement.window
    for name in ("n_ready", "load", "settled_load", "sampled_load", "peak_rays"):
        pes[name] = n_pixels
    pes["peak_object_bytes"] = pes["held_bytes"]
    pes["peak_bytes"] = pes["held_bytes"] + n_pixels * state["ray_bytes"]
    state.runs["rays_left"] = len(placement.pixel_pes)
