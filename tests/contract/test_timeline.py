"""What must hold of every timeline: it accounts for all time of all PEs, and for all messages."""

from __future__ import annotations

import numpy as np
import pytest
from builders import Case, cases
from hypothesis import given, settings
from numpy.typing import NDArray

from simmpp.engine import sizes as start
from simmpp.engine import state
from simmpp.engine.arrays.records import ARRIVAL, COMPUTE, NONE, RECEIVE, SEND
from simmpp.engine.record.recording import Recording
from simmpp.engine.result import Result
from simmpp.engine.simulate import ENGINES, simulate
from simmpp.machine.messages import LOAD
from simmpp.report.timeline.slices import COMMUNICATION, IDLE, Timeline, TimelinePart, Window

pytestmark = pytest.mark.parametrize("engine", ENGINES)
many = settings(max_examples=25, deadline=None, derandomize=True)


def timeline_of(
    engine: str, case: Case, log_rows: int = 3, window: Window | None = None
) -> tuple[Result, list[TimelinePart]]:
    """A run and the parts of its timeline, handed on in small portions."""
    window = window or Window()
    timeline = Timeline(case.machine.processors, case.machine.probe_ps, window)
    parts: list[TimelinePart] = []
    with pytest.MonkeyPatch.context() as patch:
        for module in (start, state):
            patch.setattr(module, "LOG_ROWS", log_rows)
        result = simulate(
            case.workload,
            case.machine,
            case.placement,
            case.policy,
            engine=engine,
            ready_order=case.ready_order,
            record=Recording(log=lambda rows: parts.append(timeline.add(rows.copy()))),
        )
    return result, [*parts, timeline.end(result.makespan_ps)]


def joined(parts: list[TimelinePart]) -> NDArray[np.void]:
    """All slices."""
    slices: NDArray[np.void] = np.concatenate([part.slices for part in parts])
    return slices


@given(case=cases())
@many
def test_slices_of_a_pe_touch_and_fill_the_makespan(engine: str, case: Case) -> None:
    result, parts = timeline_of(engine, case)
    slices = joined(parts)
    assert (slices["end_ps"] >= slices["time_ps"]).all()
    for pe in range(case.machine.processors):
        own = slices[slices["pe"] == pe]
        assert own["time_ps"].tolist() == [0, *own["end_ps"][:-1].tolist()][: len(own)]
        assert (own["end_ps"][-1] if len(own) else 0) == result.makespan_ps


@given(case=cases())
@many
def test_sums_of_slices_are_the_accounts(engine: str, case: Case) -> None:
    result, parts = timeline_of(engine, case)
    slices = joined(parts)
    accounts = {
        "compute_ps": (COMPUTE,),
        "communication_ps": COMMUNICATION,
        "waiting_ps": (IDLE,),
    }
    for name, events in accounts.items():
        total = np.zeros(case.machine.processors, np.int64)
        chosen = slices[np.isin(slices["event"], events)]
        np.add.at(total, chosen["pe"], chosen["end_ps"] - chosen["time_ps"])
        assert total.tolist() == getattr(result, name).tolist(), name


@given(case=cases())
@many
def test_every_message_received_is_an_arrow_from_its_packing(engine: str, case: Case) -> None:
    result, parts = timeline_of(engine, case)
    slices = joined(parts)
    departed = slices[(slices["event"] == SEND) & (slices["number"] != NONE)]
    sent = {(s["pe"], s["number"]): s for s in departed}
    assert len(sent) == len(departed) == result.messages
    arrows = np.concatenate([part.arrows for part in parts])
    tails_ps = np.concatenate([part.tails_ps for part in parts])
    assert len(arrows) == result.messages_received
    for head, tail_ps in zip(arrows, tails_ps, strict=True):
        send = sent.pop((head["other"], head["number"]))
        assert head["event"] == RECEIVE
        assert (send["time_ps"], send["other"]) == (tail_ps, head["pe"])
        assert send["end_ps"] <= head["time_ps"]
        for name in ("kind", "rays", "payload_bytes"):
            assert send[name] == head[name]
    assert all(left["kind"] == LOAD for left in sent.values())


@given(case=cases())
@many
def test_messages_in_flight_are_those_that_left_and_have_not_arrived(
    engine: str, case: Case
) -> None:
    _, parts = timeline_of(engine, case)
    slices = joined(parts)
    departures = slices["end_ps"][(slices["event"] == SEND) & (slices["number"] != NONE)]
    arrivals = np.concatenate([part.arrivals["time_ps"] for part in parts])
    assert all((part.arrivals["event"] == ARRIVAL).all() for part in parts)
    times_ps = np.concatenate([part.flights_ps for part in parts])
    counts = np.concatenate([part.in_flight for part in parts])
    assert (np.diff(times_ps) >= 0).all()
    last = {int(time): int(n) for time, n in zip(times_ps, counts, strict=True)}
    for time in {*departures.tolist(), *arrivals.tolist()}:
        assert last[time] == (departures <= time).sum() - (arrivals <= time).sum()


@given(case=cases())
@many
def test_loads_change_as_the_log_says(engine: str, case: Case) -> None:
    _, parts = timeline_of(engine, case)
    slices, loads = joined(parts), np.concatenate([part.loads for part in parts])
    for pe in range(case.machine.processors):
        held = slices[(slices["pe"] == pe) & (slices["load"] != NONE)][["load", "ready"]].tolist()
        told = loads[loads["pe"] == pe][["load", "ready"]].tolist()
        assert told == [now for k, now in enumerate(held) if k == 0 or now != held[k - 1]]
        assert not held or held[-1] == (0, 0)


@given(case=cases())
@many
def test_a_window_is_the_same_timeline_cut(engine: str, case: Case) -> None:
    result, parts = timeline_of(engine, case)
    window = Window(result.makespan_ps // 3, 1 + 2 * result.makespan_ps // 3)
    cut = joined(timeline_of(engine, case, window=window)[1])
    expected: dict[int, int] = {}
    for row in joined(parts):
        begin, end = max(row["time_ps"], window.start_ps), min(row["end_ps"], window.end_ps)
        if end > begin:
            expected[int(row["event"])] = expected.get(int(row["event"]), 0) + int(end - begin)
    got: dict[int, int] = {}
    for row in cut:
        if row["end_ps"] > row["time_ps"]:
            length = int(row["end_ps"] - row["time_ps"])
            got[int(row["event"])] = got.get(int(row["event"]), 0) + length
    assert got == expected


@given(case=cases())
@many
def test_portions_are_the_whole_log(engine: str, case: Case) -> None:
    portions: list[NDArray[np.void]] = []
    arguments = (case.workload, case.machine, case.placement, case.policy)
    options = {"engine": engine, "ready_order": case.ready_order}
    whole = simulate(*arguments, **options, record=Recording(log=True)).log
    with pytest.MonkeyPatch.context() as patch:
        for module in (start, state):
            patch.setattr(module, "LOG_ROWS", 1)
        noted = Recording(log=lambda rows: portions.append(rows.copy()))
        simulate(*arguments, **options, record=noted)
    assert whole is not None
    assert sorted(np.concatenate(portions).tolist()) == sorted(whole.tolist())
    ends = [int(rows["end_ps"].max()) for rows in portions if len(rows)]
    later = [int(rows["end_ps"].min()) for rows in portions if len(rows)]
    assert all(end <= after for end, after in zip(ends, later[1:], strict=False))
