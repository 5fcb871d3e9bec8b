"""What must hold of every run, whoever decides where the rays and the objects go."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from builders import Case, cases, everywhere, policies_of, with_policy
from hypothesis import given, settings
from implementations import outcome_of, result_of
from numpy.typing import NDArray

from simmpp.engine.record.log import EVENT_KINDS
from simmpp.engine.result import Result
from simmpp.engine.simulate import ENGINES
from simmpp.machine.messages import LOAD, MESSAGE_KINDS, OBJECT
from simmpp.machine.uneven import NOBODY

pytestmark = pytest.mark.parametrize("engine", ENGINES)
many = settings(max_examples=30, deadline=None, derandomize=True)


def rows(result: Result, event: str, kind: int | None = None) -> NDArray[np.void]:
    """Rows of the event log of one event, and of one kind of message."""
    log = result.log
    assert log is not None
    chosen = log["event"] == EVENT_KINDS.index(event)
    found: NDArray[np.void] = log[chosen if kind is None else chosen & (log["kind"] == kind)]
    return found


@given(case=cases())
@many
def test_the_accounts_of_every_pe_fill_the_makespan(engine: str, case: Case) -> None:
    result = result_of(engine, case)
    total = result.compute_ps + result.communication_ps + result.waiting_ps
    assert (total == result.makespan_ps).all()
    assert min(result.compute_ps.min(), result.communication_ps.min()) >= 0
    assert result.waiting_ps.min() >= 0


@given(case=cases())
@many
def test_every_message_sent_is_received_or_a_load_in_flight(engine: str, case: Case) -> None:
    result = result_of(engine, case)
    for kind, name in enumerate(MESSAGE_KINDS):
        own = (result.user_messages, result.steal_messages, result.tally_messages)
        by_kind = (*result.messages_by_kind, *own)
        sent, received = by_kind[kind], len(rows(result, "receive", kind))
        assert received <= sent, name
        assert received == sent or kind == LOAD, name
    assert result.messages_received == len(rows(result, "receive"))
    assert result.objects_fetched == result.object_parts == result.request_parts


@given(case=cases())
@many
def test_bytes_are_payloads_and_headers(engine: str, case: Case) -> None:
    result, machine = result_of(engine, case), case.machine
    for row in rows(result, "receive"):
        if row["kind"] != OBJECT:  # an object has bytes of its own
            expected = row["rays"] * machine.ray_bytes + row["requests"] * machine.request_bytes
            assert row["payload_bytes"] == expected
    payload = int(rows(result, "receive", OBJECT)["payload_bytes"].sum())
    payload += result.rays_sent * machine.ray_bytes
    payload += result.request_parts * machine.request_bytes
    assert result.bytes_sent == payload + result.messages * machine.header_bytes


@given(case=cases())
@many
def test_every_test_of_the_itineraries_is_made_once_and_in_order(engine: str, case: Case) -> None:
    workload, tested = case.workload, outcome_of(result_of(engine, case)).tested
    made: list[list[int]] = [[] for _ in range(workload.n_rays)]
    for ray, obj in tested:
        made[ray].append(obj)
    offsets = workload.itinerary_offsets
    for ray, objects in enumerate(made):
        assert objects == workload.itinerary_objects[offsets[ray] : offsets[ray + 1]].tolist()


@given(case=cases())
@many
def test_rays_and_tests_are_those_of_the_workload(engine: str, case: Case) -> None:
    result = result_of(engine, case)
    assert (result.rays, result.tests) == (case.workload.n_rays, case.workload.n_tests)
    assert int(rows(result, "compute")["tests"].sum()) == case.workload.n_tests
    assert result.log is not None
    assert result.events == len(result.log) - len(rows(result, "send"))


@given(case=cases())
@many
def test_what_a_pe_does_follows_one_another(engine: str, case: Case) -> None:
    result = result_of(engine, case)
    assert result.log is not None
    busy = result.log[result.log["event"] != EVENT_KINDS.index("arrival")]
    for pe in range(case.machine.processors):
        own = busy[busy["pe"] == pe]
        assert (own["end_ps"] >= own["time_ps"]).all()
        assert (own["end_ps"] <= result.makespan_ps).all()
        assert (own["time_ps"][1:] >= own["end_ps"][:-1]).all()
        length = int((own["end_ps"] - own["time_ps"]).sum())
        assert length == result.compute_ps[pe] + result.communication_ps[pe]


@given(case=cases())
@many
def test_total_compute_is_the_same_under_every_policy(engine: str, case: Case) -> None:
    alike = {"speed": (), "noise": "0", "straggler": NOBODY}
    case = replace(case, machine=replace(case.machine, **alike))
    results = [result_of(engine, each) for each in policies_of(case)]
    totals = {int((result.compute_ps - result.launch_ps).sum()) for result in results}
    assert totals == {result.work_ps for result in results} and len(totals) == 1


@given(case=cases())
@many
def test_replicated_sends_nothing(engine: str, case: Case) -> None:
    result = result_of(engine, with_policy(case, name="replicated"))
    assert result.messages_by_kind == (0, 0, 0, 0)
    assert result.bytes_sent == result.rays_sent == 0


def assert_all_are_replicated(engine: str, case: Case) -> None:
    """Every policy gives what replicated gives."""
    expected = outcome_of(result_of(engine, with_policy(case, name="replicated")))
    for each in policies_of(case):
        outcome = outcome_of(result_of(engine, each))
        assert replace(outcome, rules_never_fired=()) == expected


@given(case=cases())
@many
def test_with_everything_everywhere_every_policy_is_replicated(engine: str, case: Case) -> None:
    assert_all_are_replicated(engine, replace(case, placement=everywhere(case.placement)))


@given(case=cases())
@many
def test_on_one_pe_every_policy_is_replicated(engine: str, case: Case) -> None:
    placement = replace(
        case.placement,
        processors=1,
        islands=1,
        owners=np.zeros_like(case.placement.owners),
        pixel_pes=np.zeros_like(case.placement.pixel_pes),
        replica_offsets=np.zeros(2, np.int64),
        replica_objects=np.zeros(0, np.int32),
    )
    machine = replace(case.machine, shape=(1, 1, 1), speed=(), straggler=NOBODY)
    alone = replace(case, machine=machine, placement=placement)
    assert_all_are_replicated(engine, alone)
    # T(1): a probe for every activity, then nothing but tests and rays
    result = result_of(engine, alone)
    probes_ps = machine.probe_ps * len(rows(result, "compute"))
    assert result.makespan_ps == int(result.compute_ps[0]) + probes_ps
    assert result.waiting_ps.tolist() == [0]


@given(case=cases())
@many
def test_object_dataflow_moves_no_rays_and_ray_dataflow_no_objects(engine: str, case: Case) -> None:
    by_object = result_of(engine, with_policy(case, name="object", refresh_ps=None))
    by_ray = result_of(engine, with_policy(case, name="ray", refresh_ps=None))
    assert by_object.rays_sent == by_object.ray_messages == 0
    assert by_ray.objects_fetched == by_ray.request_parts == 0


@given(case=cases())
@many
def test_every_transfer_makes_a_test(engine: str, case: Case) -> None:
    # rays never bounce, objects are never fetched in vain: the progress that the engine enforces
    result = result_of(engine, case)
    assert result.rays_sent + result.objects_fetched <= result.tests


@given(case=cases())
@many
def test_a_run_repeated_is_the_same(engine: str, case: Case) -> None:
    assert outcome_of(result_of(engine, case)) == outcome_of(result_of(engine, case))
