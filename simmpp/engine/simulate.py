"""One run: a workload, a machine, a placement and a policy give a result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError, ModelError
from simmpp.engine.arrays.hashtable import USED
from simmpp.engine.arrays.records import NONE
from simmpp.engine.check import check_fit
from simmpp.engine.compiled_engine import CompiledRun
from simmpp.engine.initial import new_state
from simmpp.engine.record.log import Collector
from simmpp.engine.record.recording import NOTHING, Recording
from simmpp.engine.result import Result
from simmpp.engine.simpy_engine import SimpyRun
from simmpp.engine.state import State
from simmpp.machine.limits import beyond_the_clock, check_counters
from simmpp.machine.machine import Machine
from simmpp.placement.placement import Placement
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.registry import POLICIES
from simmpp.policy.rules import DataflowPolicy
from simmpp.workload.workload import Workload

ENGINES: dict[str, type[SimpyRun] | type[CompiledRun]] = {
    "simpy": SimpyRun,
    "compiled": CompiledRun,
}
DEFAULT_ENGINE = "compiled"
READY_ORDERS = ("depth-first", "breadth-first")


def simulate(
    workload: Workload,
    machine: Machine,
    placement: Placement,
    policy: PolicyParameters,
    *,
    engine: str = DEFAULT_ENGINE,
    ready_order: str = "depth-first",
    record: Recording = NOTHING,
    progress: Callable[[int], None] | None = None,
) -> Result:
    """Replay a workload on a simulated machine.

    ``record`` says what is noted besides the totals. ``progress`` is called now and then with the
    number of rays left.

    Raises ConfigError or WorkloadError on arguments that do not fit together, ModelError if rays
    are left and nothing is scheduled (a bug, or a policy that starves).
    """
    _check(workload, machine, placement, policy, engine, ready_order)
    collector = Collector()
    recording = replace(record, log=collector) if record.log is True else record
    state = new_state(
        workload, machine, placement, policy, ready_order=ready_order, recording=recording
    )
    run = ENGINES[engine](state, progress)
    try:
        run.run()
    except OverflowError:
        raise beyond_the_clock() from None
    state.close_log()
    rows = collector.rows() if record.log is True else None
    return _conclude(state, run.arrivals, policy, engine, rows)


def _check(
    workload: Workload,
    machine: Machine,
    placement: Placement,
    policy: PolicyParameters,
    engine: str,
    ready_order: str,
) -> None:
    if policy.name not in POLICIES:
        raise ConfigError(f"no policy '{policy.name}'; expected one of {', '.join(POLICIES)}")
    if engine not in ENGINES:
        raise ConfigError(f"no engine '{engine}'; expected one of {', '.join(ENGINES)}")
    if ready_order not in READY_ORDERS:
        raise ConfigError(f"no order '{ready_order}'; expected one of {', '.join(READY_ORDERS)}")
    check_fit(workload, machine, placement)
    check_counters(workload, machine)


def _conclude(
    state: State,
    arrivals: int,
    policy: PolicyParameters,
    engine: str,
    log: NDArray[np.void] | None,
) -> Result:
    """Clip the accounts at the makespan and check that the machine lost nothing."""
    makespan_ps = state["last_ray_ps"]
    overrun_ps = np.maximum(state.pes["busy_until_ps"] - makespan_ps, 0)
    communication_ps = state.pes["communication_ps"] - overrun_ps
    compute_ps = state.pes["compute_ps"].copy()
    waiting_ps = makespan_ps - compute_ps - communication_ps
    sent_by_kind, bytes_sent = _sent_by(state, makespan_ps)
    if (waiting_ps < 0).any() or (communication_ps < 0).any():
        raise ModelError(f"the accounts of a PE exceed the makespan of {makespan_ps} ps")
    return Result(
        policy=policy.title,
        engine=engine,
        makespan_ps=makespan_ps,
        messages_by_kind=sent_by_kind,
        messages_received=state["received"],
        bytes_sent=bytes_sent,
        rays=state["rays_done"],
        tests=state["tests"],
        rays_sent=state["rays_sent"],
        compute_ps=compute_ps,
        communication_ps=communication_ps,
        waiting_ps=waiting_ps,
        pe_peak_rays=state.pes["peak_rays"].copy(),
        pe_peak_bytes=state.pes["peak_bytes"].copy(),
        pe_peak_object_bytes=state.pes["peak_object_bytes"].copy(),
        events=state["activities"] + arrivals,
        rules_never_fired=_never_fired(POLICIES[policy.name], sent_by_kind),
        log=log,
        counters=state.counters() if state["record_counters"] else None,
        ray_hops=state.arrays["rays"]["hops"] if state["record_hops"] else None,
        tested_rays=state.arrays["tested_rays"] if state["record_tests"] else None,
        tested_objects=state.arrays["tested_objects"] if state["record_tests"] else None,
    )


def _sent_by(state: State, end_ps: int) -> tuple[tuple[int, int, int, int], int]:
    """Messages and bytes that had departed at the end; only load messages can be later."""
    pool = state.messages[: state.arrays["message_marks"][USED]]
    late = pool[(pool["kind"] != NONE) & (pool["depart_ps"] > end_ps)]
    by_kind = state.arrays["sent_by_kind"] - np.bincount(late["kind"], minlength=4)
    header_bytes = state["header_bytes"]
    late_bytes = int(late["payload_bytes"].sum()) + header_bytes * len(late)
    requests, objects, rays, loads = (int(n) for n in by_kind)
    return (requests, objects, rays, loads), state["bytes_sent"] - late_bytes


def _never_fired(
    policy: DataflowPolicy, sent_by_kind: tuple[int, int, int, int]
) -> tuple[str, ...]:
    requests, _, rays, _ = sent_by_kind
    fired = {"send": not policy.sends or rays > 0, "ask": not policy.asks or requests > 0}
    return tuple(rule for rule, it_did in fired.items() if not it_did)
