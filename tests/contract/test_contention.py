"""What must hold of every run with contention, and that random machines do contend."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from builders import Case, cases, random_case
from hypothesis import given, settings
from implementations import outcome_of, result_of
from oracles.costs import transfer_ps

from simmpp.engine.log import EVENT_KINDS
from simmpp.engine.simulate import ENGINES, simulate
from simmpp.machine.links import LINKS, NO_CONTENTION
from simmpp.machine.machine import UNLIMITED

many = settings(max_examples=30, deadline=None, derandomize=True)


def on(case: Case, **machine: object) -> Case:
    """The case on a machine with other constants."""
    return replace(case, machine=replace(case.machine, **machine))  # type: ignore[arg-type]


@pytest.mark.parametrize("engine", ENGINES)
@given(case=cases())
@many
def test_links_that_take_no_time_are_always_free(engine: str, case: Case) -> None:
    # no hop latency: heads reach every link in the order in which they departed
    case = on(case, link_bytes_per_s=UNLIMITED, injection_bytes_per_s=UNLIMITED, hop_latency_ps=0)
    case = on(case, latency_ps=case.machine.latency_ps + 1)  # or ties are in another order
    free = outcome_of(result_of(engine, on(case, contention=NO_CONTENTION)))
    assert outcome_of(result_of(engine, on(case, contention=LINKS))) == free


@pytest.mark.parametrize("engine", ENGINES)
@given(case=cases())
@many
def test_an_ejection_port_serves_one_message_at_a_time(engine: str, case: Case) -> None:
    machine = case.machine
    limits = (machine.link_bytes_per_s, machine.injection_bytes_per_s)
    slowest = min((limit for limit in limits if limit != UNLIMITED), default=UNLIMITED)
    log = result_of(engine, on(case, contention=LINKS)).log
    assert log is not None
    arrivals = log[log["event"] == EVENT_KINDS.index("arrival")]
    free_ps = np.zeros(machine.processors, np.int64)
    for row in arrivals:
        n_bytes = int(row["payload_bytes"]) + machine.header_bytes
        assert row["time_ps"] - transfer_ps(n_bytes, slowest) >= free_ps[row["pe"]]
        free_ps[row["pe"]] = row["time_ps"]


def test_random_machines_contend() -> None:
    def makespan_ps(case: Case, contention: str) -> int:
        case = on(case, contention=contention)
        arguments = (case.workload, case.machine, case.placement, case.policy)
        return simulate(*arguments).makespan_ps

    drawn = [random_case(seed) for seed in range(200)]
    assert sum(case.machine.contention == LINKS for case in drawn) > 50
    moved = sum(makespan_ps(case, LINKS) > makespan_ps(case, NO_CONTENTION) for case in drawn)
    assert moved > 50, moved
