"""A thread or a network card that serves: times worked out by hand on the machine of ``by_hand``.

PE 0 needs object 1 (50 bytes), and PE 1, whose it is, begins a quantum of four tests at 0 that
lasts until 1 + 4 x 1500 = 6001. PE 0 sees at 1, after a probe, that it has to ask.
"""

from __future__ import annotations

from dataclasses import replace

import pytest
from by_hand import NEVER_SENDS, OBJECT, RAY, activities_of, case_of
from implementations import IMPLEMENTATIONS, run

pytestmark = pytest.mark.parametrize("implementation", IMPLEMENTATIONS)

BUSY_OWNER = [(0, [1]), *[(1, [1])] * 4]
THREAD = {"service": "thread", "handoff_ps": 5}
NIC = {"service": "nic", "get_startup_ps": 3, "completion_ps": 4}


def test_a_polling_owner_answers_when_its_quantum_is_over(implementation: str) -> None:
    outcome = run(implementation, case_of(OBJECT, BUSY_OWNER))
    # asked for at 1 + 12, there at 155; 6001 + 26 + 63 answers, 184 + 77 later it is unpacked
    assert activities_of(outcome, 1) == [
        (0, "compute", 6001, 4),
        (6001, "receive request", 6090, 0),
    ]
    assert activities_of(outcome, 0)[1:] == [
        (6274, "receive object", 6351, 0),
        (6351, "compute", 7852, 1),
    ]


def test_a_thread_answers_at_once(implementation: str) -> None:
    outcome = run(implementation, case_of(OBJECT, BUSY_OWNER, **THREAD))
    assert activities_of(outcome, 1) == [
        (0, "compute", 6001, 4),
        (155, "serve request", 155 + 26 + 63, 0),
    ]
    # the object departs at 244 and is there at 428; the thread unpacks it until 505
    assert activities_of(outcome, 0) == [
        (0, "compute", 13, 0),
        (428, "serve object", 505, 0),
        (505, "receive object", 510, 0),
        (510, "compute", 510 + 1 + 1500, 1),
    ]
    assert outcome.makespan_ps == 6001
    assert outcome.service_ps == [77, 26 + 63]
    assert outcome.communication_ps == [1 + 12 + 5 + 1, 1]


def test_a_thread_unpacks_rays_while_its_pe_computes(implementation: str) -> None:
    outcome = run(implementation, case_of(RAY, [(0, [1]), *BUSY_OWNER], **THREAD))
    # two rays depart at 1 + 34 and are there at 189; PE 1 takes them over when it has computed
    assert activities_of(outcome, 1) == [
        (0, "compute", 6001, 4),
        (189, "serve rays", 189 + 48, 0),
        (6001, "receive rays", 6006, 0),
        (6006, "compute", 6006 + 1 + 2 * 1500, 2),
    ]
    assert outcome.service_ps == [0, 48]


def test_a_network_card_sends_an_object_back_at_once(implementation: str) -> None:
    outcome = run(implementation, case_of(OBJECT, BUSY_OWNER, **NIC))
    # 1 + 3, 142 there, 184 back, 4: the object is there at 334
    assert activities_of(outcome, 0) == [
        (0, "compute", 4, 0),
        (330, "receive object", 334, 0),
        (334, "compute", 334 + 1 + 1500, 1),
    ]
    assert activities_of(outcome, 1) == [(0, "compute", 6001, 4)]
    assert outcome.communication_ps == [1 + 3 + 4 + 1, 1]
    assert outcome.messages_by_kind == (1, 1, 0, 0)
    assert outcome.messages_received == 2
    assert outcome.bytes_sent == 4 + 8 + 4 + 50
    assert outcome.service_ps == [0, 0]


def test_rays_are_put_and_seen_for_a_completion(implementation: str) -> None:
    outcome = run(implementation, case_of(RAY, [(0, [1])], **NIC))
    # 24 to send a ray and 144 on its way, as ever; 4 + 8 + 10 to see and unpack it
    assert activities_of(outcome, 1) == [
        (1 + 24 + 144, "receive rays", 169 + 22, 0),
        (191, "compute", 191 + 1501, 1),
    ]


def test_two_gets_wait_for_the_port_of_the_owner(implementation: str) -> None:
    rays = [(0, [1]), *[(1, [1])] * 4, (2, [1])]
    case = case_of(OBJECT, rays, owners=(0, 1), shape=(3, 1, 1), **NIC)
    case = replace(case, machine=replace(case.machine, contention="links"))
    outcome = run(implementation, case)
    # Both gets are before the owner's port at 4 + 100 + 30; that takes 12 of each. The objects
    # depart at 146 and 158, but the port out is busy with the first until 146 + 54.
    received = [row[0] for k in (0, 2) for row in activities_of(outcome, k) if "object" in row[1]]
    assert received == [146 + 130 + 54, 200 + 130 + 54]


def test_loads_are_got(implementation: str) -> None:
    outcome = run(implementation, case_of(replace(NEVER_SENDS, refresh_ps=0), BUSY_OWNER, **NIC))
    # An object tells no load: one is got at 334, for 3, and is there 142 + 142 later, while PE 0
    # computes; another at the end of that. A load that was got asks for none.
    assert activities_of(outcome, 0)[1:] == [
        (330, "receive object", 334 + 3, 0),
        (337, "compute", 337 + 1501 + 3, 1),
        (1841, "receive load", 1845, 0),
        (1841 + 142 + 142, "receive load", 2129, 0),
    ]
    assert outcome.messages_by_kind == (1, 1, 0, 4)
    assert outcome.bytes_sent == 4 + 8 + 4 + 50 + 2 * (4 + 8 + 4 + 8)
