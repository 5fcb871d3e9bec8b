"""The trace of a machine worked out by hand, and what the format asks of every trace."""

from __future__ import annotations

import contextlib
import gzip
import json
from decimal import Decimal
from itertools import pairwise
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
from builders import Case, cases, placement_of, workload_of
from by_hand import MACHINE, OBJECT
from hypothesis import given, settings

from simmpp.engine import sizes as start
from simmpp.engine import state
from simmpp.engine.record.recording import Recording
from simmpp.engine.simulate import ENGINES, simulate
from simmpp.report.timeline.recorder import TimelineRecorder
from simmpp.report.timeline.slices import Window
from simmpp.run.point import PolicyRun

WORKLOAD = workload_of(primaries=1, itineraries=[[0, 1]], object_bytes=(40, 50))
CASE = Case(WORKLOAD, MACHINE, placement_of((0, 1), [0], 2), OBJECT)
"""tests/by_hand.py explains each time: one ray fetches one object."""


def record(path: Path, case: Case, engine: str = "compiled", window: Window | None = None) -> int:
    """The case's timeline in a file; returns the makespan."""
    recorder = TimelineRecorder(path, case.machine, window)
    with contextlib.closing(recorder):
        result = simulate(
            case.workload,
            case.machine,
            case.placement,
            case.policy,
            engine=engine,
            ready_order=case.ready_order,
            record=Recording(log=recorder.begin(case.policy)),
        )
        recorder.end(PolicyRun(case.policy, result, named=True, wall_s=0.0))
    return result.makespan_ps


def trace(path: Path) -> list[dict[str, Any]]:
    """The events of a trace, their times exact."""
    content = json.loads(path.read_bytes(), parse_float=Decimal)
    assert content["displayTimeUnit"] == "ns"
    events: list[dict[str, Any]] = content["traceEvents"]
    return events


def ps(event: dict[str, Any]) -> int:
    """The time of an event in picoseconds."""
    time = event["ts"] * 10**6
    assert isinstance(time, Decimal)
    assert time == int(time)
    return int(time)


def slices(events: list[dict[str, Any]]) -> list[tuple[int, int, str, int]]:
    """(PE, begin, name, end) of the slices, in the order in which they begin in the file."""
    found = []
    for begin, end in pairwise(events):
        if begin["ph"] == "B":
            assert end["ph"] == "E"
            assert end["tid"] == begin["tid"]
            found.append((begin["tid"] - 1, ps(begin), begin["name"], ps(end)))
    return found


@pytest.mark.parametrize("engine", ENGINES)
def test_a_machine_by_hand(tmp_path: Path, engine: str) -> None:
    makespan_ps = record(tmp_path / "t.json", CASE, engine)
    events = trace(tmp_path / "t.json")
    assert makespan_ps == 3006
    assert sorted(slices(events)) == [
        (0, 0, "probe", 1),
        (0, 1, "compute", 1001),
        (0, 1001, "send request", 1013),
        (0, 1013, "idle", 1428),
        (0, 1428, "receive object", 1505),
        (0, 1505, "probe", 1506),
        (0, 1506, "compute", 3006),
        (1, 0, "idle", 1155),
        (1, 1155, "receive request", 1181),
        (1, 1181, "send object", 1244),
        (1, 1244, "idle", 3006),
    ]
    arrows = [(e["ph"], e["id"], e["tid"] - 1, ps(e), e["name"]) for e in events if "id" in e]
    assert arrows == [
        ("s", 0, 0, 1001, "request"),
        ("f", 0, 1, 1155, "request"),
        ("s", 1, 1, 1181, "object"),
        ("f", 1, 0, 1428, "object"),
    ]
    counters = [(e["name"], ps(e), e["args"]) for e in events if e["ph"] == "C"]
    assert [each for each in counters if each[0] == "messages in flight"] == [
        ("messages in flight", time, {"messages": n})
        for time, n in ((1013, 1), (1155, 0), (1244, 1), (1428, 0))
    ]
    assert [each for each in counters if each[0] == "PE 0"] == [
        ("PE 0", 1001, {"load": 1, "ready": 0, "waiting": 1}),
        ("PE 0", 1505, {"load": 1, "ready": 1, "waiting": 0}),
        ("PE 0", 3006, {"load": 0, "ready": 0, "waiting": 0}),
    ]
    names = [(e["name"], e["tid"], e["args"]) for e in events if e["ph"] == "M"]
    assert names == [
        ("process_name", 1, {"name": "object"}),
        ("thread_name", 1, {"name": "PE 0"}),
        ("thread_name", 2, {"name": "PE 1"}),
    ]
    compute = next(e for e in events if e["ph"] == "B" and ps(e) == 1506)
    assert compute["args"] == {"tests": 1, "rays finished": 1}
    answer = next(e for e in events if e["ph"] == "B" and ps(e) == 1181)
    assert answer["args"] == {"other PE": 0, "number": 0, "rays": 0, "bytes": 50}
    assert answer["cat"] == "communication"


def test_the_same_as_parquet(tmp_path: Path) -> None:
    record(tmp_path / "t.json", CASE)
    record(tmp_path / "t.parquet", CASE)
    whole = pq.read_table(tmp_path / "t.parquet")
    work = [row for row in whole.to_pylist() if row["event"] != "arrival"]
    names = [f"{row['event']} {row['kind'] or ''}".rstrip() for row in work]
    rows = [
        (r["pe"], r["begin_ps"], name, r["end_ps"]) for r, name in zip(work, names, strict=True)
    ]
    assert rows == slices(trace(tmp_path / "t.json"))
    table = whole.to_pandas()
    arrivals = table[table["event"] == "arrival"]
    assert arrivals[["pe", "other", "begin_ps", "payload_bytes"]].to_numpy().tolist() == [
        [1, 0, 1155, 8],
        [0, 1, 1428, 50],
    ]
    assert set(table["policy"]) == {"object"}
    computed = table[table["event"] == "compute"]
    assert computed[["tests", "rays", "load"]].to_numpy().astype(int).tolist() == [
        [1, 0, 1],
        [1, 1, 0],
    ]
    assert computed["other"].isna().all()


def test_a_window_cuts_slices_and_leaves_out_what_is_not_in_it(tmp_path: Path) -> None:
    record(tmp_path / "t.json", CASE, window=Window(1100, 1200))
    events = trace(tmp_path / "t.json")
    assert sorted(slices(events)) == [
        (0, 1100, "idle", 1200),
        (1, 1100, "idle", 1155),
        (1, 1155, "receive request", 1181),
        (1, 1181, "send object", 1200),
    ]
    assert not [e for e in events if e["ph"] in "sf"]
    counters = [(e["name"], ps(e), e["args"]) for e in events if e["ph"] == "C"]
    assert counters == [
        ("PE 1", 1181, {"load": 0, "ready": 0, "waiting": 0}),
        ("messages in flight", 1155, {"messages": 0}),
    ]


def test_compressed_it_is_the_same(tmp_path: Path) -> None:
    record(tmp_path / "t.json", CASE)
    record(tmp_path / "t.json.gz", CASE)
    assert (
        gzip.decompress((tmp_path / "t.json.gz").read_bytes()) == (tmp_path / "t.json").read_bytes()
    )


REQUIRED = {
    "B": {"pid", "tid", "ts", "name", "cat"},
    "E": {"pid", "tid", "ts"},
    "s": {"pid", "tid", "ts", "name", "cat", "id"},
    "f": {"pid", "tid", "ts", "name", "cat", "id", "bp"},
    "C": {"pid", "ts", "name", "args"},
    "M": {"pid", "tid", "name", "args"},
}
"""Fields that the Trace Event Format asks for, by the kind of event."""


def assert_well_formed(events: list[dict[str, Any]]) -> None:
    """What the format asks: fields, nesting in the order of time, both ends of flows, numbers."""
    depth: dict[tuple[int, int], int] = {}
    now: dict[tuple[int, int], int] = {}
    for event in events:
        assert set(event) - {"ph", "args"} == REQUIRED[event["ph"]] - {"args"}
        track = event["pid"], event.get("tid", -1)
        assert event["ph"] == "C" or event["tid"] > 0  # Perfetto takes 0 for the process's own
        if event["ph"] in "BE":
            depth[track] = depth.get(track, 0) + (1 if event["ph"] == "B" else -1)
            assert depth[track] in (0, 1)
            assert ps(event) >= now.get(track, 0)
            now[track] = ps(event)
        if event["ph"] == "C":
            assert all(isinstance(value, int) for value in event["args"].values())
    assert not any(depth.values())
    for phase in "sf":
        flows = [event["id"] for event in events if event["ph"] == phase]
        assert flows == list(range(len(flows)))


@given(case=cases())
@settings(max_examples=12, deadline=None, derandomize=True)
def test_every_trace_is_well_formed_and_engines_write_the_same_bytes(
    tmp_path_factory: pytest.TempPathFactory, case: Case
) -> None:
    folder = tmp_path_factory.mktemp("trace")
    with pytest.MonkeyPatch.context() as patch:
        for module in (start, state):  # many parts
            patch.setattr(module, "LOG_ROWS", 3)
        for engine in ENGINES:
            record(folder / f"{engine}.json", case, engine)
    assert (folder / "simpy.json").read_bytes() == (folder / "compiled.json").read_bytes()
    events = trace(folder / "simpy.json")
    assert_well_formed(events)
    record(folder / "whole.json", case)
    whole = trace(folder / "whole.json")
    assert sorted(slices(whole)) == sorted(slices(events))
