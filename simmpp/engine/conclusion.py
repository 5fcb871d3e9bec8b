"""The end of a run: its state becomes a result, whose accounts add up."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ModelError
from simmpp.engine.arrays.records import SINGLY
from simmpp.engine.memory_use import MemoryUse
from simmpp.engine.result import Result
from simmpp.engine.state import State
from simmpp.engine.tables.residuals import times_of_residuals
from simmpp.engine.tables.rounds import barriers, round_ends
from simmpp.engine.tables.tallies import Reduction
from simmpp.machine.machine import Machine
from simmpp.machine.messages import LOAD, OBJECT, RAYS, REQUEST
from simmpp.machine.uneven import bound_of
from simmpp.workload.workload import Workload


def concluded(
    state: State,
    arrivals: int,
    policy: str,
    engine: str,
    log: NDArray[np.void] | None,
    use: MemoryUse | None,
    machine: Machine,
    workload: Workload,
    reduction: Reduction,
    work_ps: int | None = None,
) -> Result:
    """Clip the accounts at the makespan and check that the machine lost nothing.

    A run that could not be brought to its end has no makespan: the time is that of its last event.
    Without ``work_ps``, that of a machine that is not uneven, PEs have computed nothing else.
    """
    makespan_ps = state["last_ray_ps"]
    if state.infeasible:
        makespan_ps = max(makespan_ps, int(state.pes["busy_until_ps"].max()))
    overrun_ps = np.maximum(state.pes["busy_until_ps"] - makespan_ps, 0)
    communication_ps = state.pes["communication_ps"] - overrun_ps
    late_ps = np.maximum(state.pes["served_until_ps"] - makespan_ps, 0)
    compute_ps = state.pes["compute_ps"].copy()
    waiting_ps = makespan_ps - compute_ps - communication_ps
    work_ps = int(compute_ps.sum()) if work_ps is None else work_ps
    (*sent, user_messages, steal_messages, deposit_messages), bytes_sent = state.sent_until(
        makespan_ps
    )
    n_barriers, barrier_ps, round_messages = barriers(state, workload, machine)
    sent_by_kind = (sent[REQUEST], sent[OBJECT], sent[RAYS], sent[LOAD])
    parts_by_kind = _parts(state, sent_by_kind)
    if (waiting_ps < 0).any() or (communication_ps < 0).any():
        raise ModelError(f"the accounts of a PE exceed the makespan of {makespan_ps} ps")
    return Result(
        policy=policy,
        engine=engine,
        makespan_ps=makespan_ps + reduction.time_ps,
        messages_by_kind=sent_by_kind,
        parts_by_kind=parts_by_kind,
        messages_received=state["received"],
        bytes_sent=bytes_sent + round_messages * machine.header_bytes + reduction.n_bytes,
        rays=state["rays_done"],
        tests=state["tests"],
        rays_sent=state["rays_sent"],
        compute_ps=compute_ps,
        communication_ps=communication_ps + reduction.time_ps,
        waiting_ps=waiting_ps,
        service_ps=state.pes["service_ps"] - late_ps,
        pe_peak_rays=state.pes["peak_rays"].copy(),
        pe_peak_bytes=state.pes["peak_bytes"].copy(),
        pe_peak_object_bytes=state.pes["peak_object_bytes"].copy(),
        events=state["activities"] + arrivals,
        user_messages=user_messages,
        user_dropped=state["user_dropped"],
        steal_messages=steal_messages,
        launch_ps=state.pes["launch_ps"].copy(),
        work_ps=work_ps,
        bound_ps=bound_of(work_ps, machine.speed, machine.processors),
        round_ends_ps=(ends_ps := round_ends(state)),
        residuals_ps=times_of_residuals(workload.round_residuals, ends_ps),
        barriers=n_barriers,
        barrier_ps=barrier_ps,
        round_messages=round_messages,
        tally_messages=deposit_messages + reduction.messages,
        deposits=state["deposited"],
        reduction_ps=reduction.time_ps,
        rules_never_fired=_never_fired(state, parts_by_kind),
        memory=use,
        log=log,
        counters=state.counters() if state["record_counters"] else None,
        ray_hops=state.arrays["rays"]["hops"] if state["record_hops"] else None,
        ray_ends_ps=state.arrays["ends_ps"] if state["record_ends"] else None,
        tested_rays=state.arrays["tested_rays"] if state["record_tests"] else None,
        tested_objects=state.arrays["tested_objects"] if state["record_tests"] else None,
    )


def _parts(state: State, sent_by_kind: tuple[int, int, int, int]) -> tuple[int, int, int, int]:
    """Only packed messages have their parts counted; of loads nothing is packed."""
    if state["packing"] == SINGLY:
        return sent_by_kind
    requests, objects, rays, *_ = state.arrays["parts_by_kind"].tolist()
    return requests, objects, rays, sent_by_kind[LOAD]


def _never_fired(state: State, parts_by_kind: tuple[int, int, int, int]) -> tuple[str, ...]:
    fired = {
        "send": not state["sends"] or parts_by_kind[RAYS] > 0,
        "ask": not state["asks"] or parts_by_kind[REQUEST] > 0,
    }
    return tuple(rule for rule, it_did in fired.items() if not it_did)
