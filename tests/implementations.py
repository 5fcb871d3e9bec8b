"""One way to run a case on the oracle or on an engine, and to see the same things of each."""

from __future__ import annotations

from builders import Case
from oracles.ledger import Activity, Outcome, Slice, in_order, who
from oracles.machine import simulate as simulate_slowly

from simmpp.engine import memory_use
from simmpp.engine.record.log import EVENT_KINDS
from simmpp.engine.record.recording import Recording
from simmpp.engine.result import Result
from simmpp.engine.simulate import ENGINES, simulate
from simmpp.machine.messages import MESSAGE_KINDS

IMPLEMENTATIONS = ("oracle", *ENGINES)
SEED = 4711
"""Of the random numbers that policies are given."""


def run(implementation: str, case: Case) -> Outcome:
    """What a run of the case gives, with its log and its tests."""
    if implementation == "oracle":
        outcome = simulate_slowly(
            case.workload, case.machine, case.placement, case.policy, case.ready_order, SEED
        )
    else:
        outcome = outcome_of(result_of(implementation, case))
    if case.policy.rests:  # what it sends belongs to no activity; slices say it all
        outcome.activities = []
    return outcome


def result_of(engine: str, case: Case) -> Result:
    """The case run on an engine, with everything recorded."""
    return simulate(
        case.workload,
        case.machine,
        case.placement,
        case.policy,
        engine=engine,
        ready_order=case.ready_order,
        seed=SEED,
        record=Recording(log=True, tests=True, hops=True, ends=True),
    )


def outcome_of(result: Result) -> Outcome:
    """An engine's result in the oracle's words."""
    arrivals, slices = [], []
    for row in result.log if result.log is not None else ():
        r = dict(zip(row.dtype.names, row.item(), strict=True))
        event, time_ps = EVENT_KINDS[r.pop("event")], r.pop("time_ps")
        if event == "arrival":
            sent = (r["other"], r["number"], MESSAGE_KINDS[r["kind"]], r["payload_bytes"])
            arrivals.append((time_ps, r["pe"], *sent))
        else:
            slices.append(Slice(begin=time_ps, what=event, end=r.pop("end_ps"), **r))
    slices.sort(key=who)
    tested_rays = [] if result.tested_rays is None else result.tested_rays.tolist()
    use = result.memory
    tested_objects = [] if result.tested_objects is None else result.tested_objects.tolist()
    return Outcome(
        makespan_ps=result.makespan_ps,
        messages_by_kind=result.messages_by_kind,
        messages_received=result.messages_received,
        bytes_sent=result.bytes_sent,
        rays=result.rays,
        tests=result.tests,
        rays_sent=result.rays_sent,
        user_messages=result.user_messages,
        user_dropped=result.user_dropped,
        steal_messages=result.steal_messages,
        parts_by_kind=result.parts_by_kind,
        compute_ps=result.compute_ps.tolist(),
        communication_ps=result.communication_ps.tolist(),
        waiting_ps=result.waiting_ps.tolist(),
        service_ps=result.service_ps.tolist(),
        peak_rays=result.peak_rays,
        peak_bytes=result.peak_bytes,
        events=result.events,
        rules_never_fired=result.rules_never_fired,
        arrivals=sorted(arrivals),
        activities=activities_of(slices),
        slices=slices,
        tested=list(zip(tested_rays, tested_objects, strict=True)),
        ray_hops=[] if result.ray_hops is None else result.ray_hops.tolist(),
        ray_ends=[] if result.ray_ends_ps is None else result.ray_ends_ps.tolist(),
        tally_messages=result.tally_messages,
        reduction_ps=result.reduction_ps,
        round_messages=result.round_messages,
        round_ends=result.round_ends_ps.tolist(),
        memory={} if use is None else {name: getattr(use, name) for name in memory_use.COLUMNS},
    )


def activities_of(slices: list[Slice]) -> list[Activity]:
    """(begin, PE, kind, end, tests): what is sent belongs to the activity that it follows."""
    of_pes: list[Activity] = []
    of_threads: list[Activity] = []
    for each in slices:
        own = of_threads if each.what in ("serve", "answer") else of_pes
        if each.what in ("send", "answer") and own:
            own[-1] = (*own[-1][:3], each.end, own[-1][4])
        elif each.what != "answer":  # that of a network card is no activity
            kind = f"{each.what} {MESSAGE_KINDS[each.kind]}" if each.kind >= 0 else each.what
            own.append((each.begin, each.pe, kind, each.end, each.tests))
    return in_order(of_pes + of_threads)
