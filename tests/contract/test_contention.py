"""What must hold of every run with contention, and that random machines do contend."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from builders import Case, cases, on_torus, random_case
from hypothesis import given, settings
from implementations import SEED, result_of, run
from oracles.costs import transfer_ps
from oracles.machine import Simulation
from oracles.network import Network, network_ps

from simmpp.engine.record.log import EVENT_KINDS
from simmpp.engine.simulate import ENGINES, simulate
from simmpp.machine.machine import UNLIMITED
from simmpp.machine.torus import LINKS, NO_CONTENTION
from simmpp.policy.parameters import POLICIES

many = settings(max_examples=30, deadline=None, derandomize=True)


def on(case: Case, **machine: object) -> Case:
    """The case on a machine with other constants."""
    return replace(case, machine=replace(case.machine, **machine))  # type: ignore[arg-type]


@pytest.mark.parametrize("engine", ENGINES)
def test_a_run_in_which_no_message_waits_is_the_one_without_contention(engine: str) -> None:
    found = 0
    for seed in range(150):
        case = on(random_case(seed), contention=LINKS)
        if waits_ps(case) == {0}:
            found += 1
            assert run(engine, case) == run(engine, on(case, contention=NO_CONTENTION)), seed
    assert found > 15, found


def waits_ps(case: Case) -> set[int]:
    """What the messages of the oracle's run waited; one that takes no time counts as waiting."""
    machine, rules, network = case.machine, POLICIES[case.policy.name], Network(case.machine)
    parts = (case.workload, machine, case.placement, case.policy, case.ready_order, rules, SEED)
    simulation = Simulation(*parts)
    simulation.run()
    sent = {(m.source, m.send_number): m for m in simulation.ledger.sent}
    waits = set()
    for time, destination, source, number, _, n_bytes in simulation.ledger.arrivals:
        message = sent[source, number]
        waits.add(time - message.departure - network_ps(machine, source, destination, n_bytes))
        if network.way(message)[-1][2] == 0:
            waits.add(1)  # its head is at the last port when it arrives: ties are in another order
    return waits


@pytest.mark.parametrize("engine", ENGINES)
@given(case=cases())
@many
def test_an_ejection_port_serves_one_message_at_a_time(engine: str, case: Case) -> None:
    case, machine = on_torus(case), case.machine
    limits = (machine.link_bytes_per_s, machine.injection_bytes_per_s)
    slowest = min((limit for limit in limits if limit != UNLIMITED), default=UNLIMITED)
    log = result_of(engine, on(case, contention=LINKS)).log
    assert log is not None
    arrivals = log[log["event"] == EVENT_KINDS.index("arrival")]
    free_ps = np.zeros(machine.processors, np.int64)
    for row in arrivals:
        busy_ps = transfer_ps(int(row["payload_bytes"]) + machine.header_bytes, slowest)
        if busy_ps > 0:  # one without bytes passes between two others
            assert row["time_ps"] - busy_ps >= free_ps[row["pe"]]
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
