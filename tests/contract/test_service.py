"""Threads and network cards that serve: every integer is the oracle's, and nothing is lost.

SIMMPP_TEST_CASES and SIMMPP_TEST_FIRST_SEED as in ``test_engine_equals_oracle``.
"""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import asdict, replace

import numpy as np
import pytest
from builders import SHARING, Case, random_case, served, some_stealing
from implementations import result_of, run
from numpy.typing import NDArray

from simmpp.engine.record.log import EVENT_KINDS
from simmpp.engine.result import Result
from simmpp.engine.simulate import ENGINES
from simmpp.machine.machine import NIC, THREAD
from simmpp.machine.torus import LINKS
from simmpp.report.timeline.slices import Timeline, Window, is_of_server

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "100"))
FIRST_SEED = int(os.environ.get("SIMMPP_TEST_FIRST_SEED", "0"))
SEEDS = range(FIRST_SEED, FIRST_SEED + CASES)
SERVERS = (THREAD, NIC)


def rows(result: Result, event: str) -> NDArray[np.void]:
    """Rows of the event log of one event."""
    assert result.log is not None
    found: NDArray[np.void] = result.log[result.log["event"] == EVENT_KINDS.index(event)]
    return found


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("service", SERVERS)
def test_every_integer_is_the_oracles(engine: str, service: str) -> None:
    for seed in SEEDS:
        assert_equal(engine, served(some_stealing(random_case(seed), seed), service, seed), seed)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("service", SERVERS)
def test_so_it_is_where_much_rides_together_and_loads_are_told(engine: str, service: str) -> None:
    for seed in SEEDS[: max(1, CASES // 4)]:
        assert_equal(engine, sharing(service, seed), seed)


def sharing(service: str, seed: int) -> Case:
    """A random case whose policy packs what it can, and often tells loads or gets them."""
    policy = replace(SHARING, refresh_ps=(None, 0, 1000)[seed % 3])
    return served(replace(random_case(seed), policy=policy), service, seed)


@pytest.mark.parametrize("service", SERVERS)
def test_nothing_is_lost_and_all_time_is_told(service: str) -> None:
    for seed in SEEDS:
        case = served(random_case(seed), service, seed)
        result = result_of("compiled", case)
        told_ps = result.compute_ps + result.communication_ps + result.waiting_ps
        assert (told_ps == result.makespan_ps).all()
        assert (result.service_ps <= result.makespan_ps).all()
        assert result.objects_fetched == result.request_parts
        received = rows(result, "serve" if service == THREAD else "receive")
        # A get of a load is one too, and its answer.
        gets = rows(result, "answer") if service == NIC else received[:0]
        assert result.messages_received == len(received) + len(gets)
        in_flight = result.messages - result.messages_received
        assert 0 <= in_flight <= result.load_messages
        payload = int(received["payload_bytes"].sum()) + len(gets) * case.machine.request_bytes
        if in_flight == 0:
            assert result.bytes_sent == payload + result.messages * case.machine.header_bytes


def test_a_thread_does_one_thing_after_another() -> None:
    for seed in SEEDS:
        result = result_of("compiled", served(random_case(seed), THREAD, seed))
        served_rows = np.concatenate([rows(result, "serve"), rows(result, "answer")])
        served_rows = served_rows[np.argsort(served_rows["time_ps"], kind="stable")]
        for pe, busy_ps in enumerate(result.service_ps):
            own = served_rows[served_rows["pe"] == pe]
            lengths_ps = own["end_ps"] - own["time_ps"]
            assert lengths_ps.sum() == busy_ps
            own = own[lengths_ps > 0]
            assert (own["time_ps"][1:] >= own["end_ps"][:-1]).all()


def test_random_machines_are_served_in_all_these_ways() -> None:
    found = Counter[str]()
    for seed in SEEDS:
        polled = random_case(seed)
        for service in SERVERS:
            case = served(polled, service, seed)
            result = result_of("compiled", case)
            found[service] += result.makespan_ps != result_of("compiled", polled).makespan_ps
            found["busy threads"] += bool(result.service_ps.any())
            found["loads told"] += result_of("compiled", sharing(service, seed)).load_messages > 0
            found["contention"] += case.machine.contention == LINKS and result.messages > 0
    assert min(found.values()) > len(SEEDS) // 20 and len(found) == 5, found


def assert_equal(engine: str, case: Case, seed: int) -> None:
    """The engine says what the oracle says."""
    expected, got = asdict(run("oracle", case)), asdict(run(engine, case))
    for name in expected:
        assert got[name] == expected[name], f"seed {seed}: {name} under {case.policy}"


@pytest.mark.parametrize("service", SERVERS)
def test_timelines_have_both_tracks_of_a_pe_and_every_flight(service: str) -> None:
    for seed in SEEDS[:20]:
        case = served(random_case(seed), service, seed)
        result, machine = result_of("compiled", case), case.machine
        assert result.log is not None
        timeline = Timeline(machine.processors, machine.probe_ps, Window(), service)
        part, last = timeline.add(result.log), timeline.end(result.makespan_ps)
        own = np.concatenate([part.slices, last.slices])
        own = own[~is_of_server(own)]
        lengths_ps = np.bincount(own["pe"], own["end_ps"] - own["time_ps"], machine.processors)
        assert (lengths_ps == result.makespan_ps).all()
        assert len(part.in_flight) == 0 or part.in_flight.min() >= 0
        heads = rows(result, "serve" if service == THREAD else "receive")
        assert len(part.arrows) == len(heads)
        of_objects = part.arrows["objects"] > 0
        assert part.tails_served[of_objects].all()
        assert (part.tails_ps <= part.arrows["time_ps"]).all()
