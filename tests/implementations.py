"""One way to run a case on the oracle or on an engine, and to see the same things of each."""

from __future__ import annotations

from builders import Case
from oracles.ledger import Outcome
from oracles.machine import simulate as simulate_slowly
from oracles.rules import Rules

from simmpp.engine.log import EVENT_KINDS
from simmpp.engine.result import Result
from simmpp.engine.simulate import ENGINES, simulate
from simmpp.machine.messages import MESSAGE_KINDS

IMPLEMENTATIONS = ("oracle", *ENGINES)


def run(implementation: str, case: Case, rules: Rules | None = None) -> Outcome:
    """What a run of the case gives, with its log and its tests; ``rules`` are the oracle's."""
    if implementation == "oracle":
        return simulate_slowly(
            case.workload, case.machine, case.placement, case.policy, case.ready_order, rules
        )
    return outcome_of(result_of(implementation, case))


def result_of(engine: str, case: Case) -> Result:
    """The case run on an engine, with everything recorded."""
    return simulate(
        case.workload,
        case.machine,
        case.placement,
        case.policy,
        engine=engine,
        ready_order=case.ready_order,
        log=True,
        record_tests=True,
    )


def outcome_of(result: Result) -> Outcome:
    """An engine's result in the oracle's words."""
    arrivals, activities = [], []
    for row in result.log if result.log is not None else ():
        time_ps, pe, kind = int(row["time_ps"]), int(row["pe"]), MESSAGE_KINDS[row["kind"]]
        event = EVENT_KINDS[row["event"]]
        if event == "arrival":
            source, number = int(row["source"]), int(row["number"])
            arrivals.append((time_ps, pe, source, number, kind, int(row["payload_bytes"])))
        else:
            name = event if event == "compute" else f"receive {kind}"
            activities.append((time_ps, pe, name, int(row["end_ps"]), int(row["tests"])))
    tested_rays = [] if result.tested_rays is None else result.tested_rays.tolist()
    tested_objects = [] if result.tested_objects is None else result.tested_objects.tolist()
    return Outcome(
        makespan_ps=result.makespan_ps,
        messages_by_kind=result.messages_by_kind,
        messages_received=result.messages_received,
        bytes_sent=result.bytes_sent,
        rays=result.rays,
        tests=result.tests,
        rays_sent=result.rays_sent,
        compute_ps=result.compute_ps.tolist(),
        communication_ps=result.communication_ps.tolist(),
        waiting_ps=result.waiting_ps.tolist(),
        peak_rays=result.peak_rays,
        peak_bytes=result.peak_bytes,
        events=result.events,
        rules_never_fired=result.rules_never_fired,
        arrivals=sorted(arrivals),
        activities=sorted(activities, key=lambda row: row[:2]),
        tested=list(zip(tested_rays, tested_objects, strict=True)),
    )
