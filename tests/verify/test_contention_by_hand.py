"""Messages that wait for one another, worked out by hand: what the oracle and the engines must say.

The machine is that of ``by_hand``, its links and ports serving one message at a time. A request
keeps each of them busy for 12 ps, an object of 50 bytes for 54, one of 40 bytes for 44. Its head
takes 100 ps from the injection port to the first link and 30 ps over each link.
"""

from __future__ import annotations

from dataclasses import replace

import pytest
from by_hand import BYTE_PER_PS, MACHINE, OBJECT, activities_of, case_of
from implementations import IMPLEMENTATIONS, run

from simmpp.machine.machine import CopyCost
from simmpp.machine.torus import LINKS
from simmpp.workload.workload import MESH, SPHERE

pytestmark = pytest.mark.parametrize("implementation", IMPLEMENTATIONS)


def test_a_message_alone_takes_as_long_as_without_contention(implementation: str) -> None:
    case = case_of(OBJECT, [(0, [0, 1])])
    alone = run(implementation, replace(case, machine=replace(MACHINE, contention=LINKS)))
    assert alone == run(implementation, case)
    assert alone.makespan_ps == 3006


def test_messages_of_a_pair_follow_one_another(implementation: str) -> None:
    # Half a byte per ps: requests take 24. They depart at 13 and 25
    # first   injection 13 to 37, link from 113 to 137, ejection from 143: arrives at 167
    # second  injection from 37, link from 137, ejection from 167: arrives at 191
    # PE 1 167 to 193, answered 256 (T = 108, arrives 256 + 130 + 108 = 494)
    # PE 1 256 to 282, answered 345: injection free at 364, link from 464, ejection from 494: 602
    policy = replace(OBJECT, merge_requests=False)
    rays = [(0, [1]), (0, [1])]
    case = case_of(policy, rays, contention=LINKS, link_bytes_per_s=BYTE_PER_PS // 2)
    outcome = run(implementation, case)
    assert outcome.arrivals == [
        (167, 1, 0, 0, "request", 8),
        (191, 1, 0, 1, "request", 8),
        (494, 0, 1, 0, "object", 50),
        (602, 0, 1, 1, "object", 50),
    ]
    assert outcome.events == len(outcome.arrivals) + len(outcome.activities)


def test_a_packed_message_keeps_links_busy_for_all_its_bytes(implementation: str) -> None:
    # A ring of 3, half a byte per ps. PE 0 at 1 asks PE 1 for objects 1 and 2: 10 + 2 + 2, to 15;
    # two requests and a header of 4 take 40. Then PE 2 for object 3, to 27; that takes 24
    # PE 1  injection 15 to 55, link from 115, ejection from 145: arrives at 185; received 217,
    #       answered 10 + (3+50) + (3+30) = 96, to 313; injection 313, link 413, ejection 443: below
    # PE 2  injection from 55, link from 155, ejection from 185: arrives at 209; received 235,
    #       answered 278; injection 278, link 378, ejection 408, for 68: arrives at 476
    # PE 1  so its answer gets the ejection port at 476, for 2 (50 + 30 + 4) = 168: arrives at 644
    case = case_of(
        replace(OBJECT, packing="requests"),
        [(0, [1]), (0, [2]), (0, [3])],
        owners=(0, 1, 1, 2),
        object_bytes=(40, 50, 30, 30),
        shape=(3, 1, 1),
        contention=LINKS,
        link_bytes_per_s=BYTE_PER_PS // 2,
    )
    assert run(implementation, case).arrivals == [
        (185, 1, 0, 0, "request", 16),
        (209, 2, 0, 1, "request", 8),
        (476, 0, 2, 0, "object", 30),
        (644, 0, 1, 0, "object", 80),
    ]


def test_two_messages_share_a_link(implementation: str) -> None:
    # Ring of 4; ways of two links go towards +. Half a byte per ps: requests take 24, objects 108.
    # Both requests depart at 13.
    # 1 to 3  injection 13, link 1 from 113 to 137, link 2 from 143, ejection 173: arrives at 197
    # 0 to 2  injection 13, link 0 from 113, link 1 from 143, when it is free again; ejection 173
    # 2 to 0  departs 197 + 26 + 63 = 286; link 2 from 386, link 3 416: see below
    # 3 to 1  departs at 286 too; link 3 from 386 to 494, link 0 416, ejection 446: arrives at 554
    # 2 to 0  so it gets link 3 at 494, ejection 524: arrives at 632
    case = case_of(
        OBJECT,
        [(0, [1]), (1, [2])],
        owners=(0, 2, 3),
        object_bytes=(40, 50, 50),
        shape=(4, 1, 1),
        contention=LINKS,
        link_bytes_per_s=BYTE_PER_PS // 2,
    )
    assert run(implementation, case).arrivals == [
        (197, 2, 0, 0, "request", 8),
        (197, 3, 1, 0, "request", 8),
        (554, 1, 3, 0, "object", 50),
        (632, 0, 2, 0, "object", 50),
    ]


def test_many_to_one_wait_for_the_ejection_port(implementation: str) -> None:
    # 3 x 2: PEs 1, 2 and 3 are neighbours of PE 0, each over a link of its own. Heads of all three
    # requests are there at 143. PE 0 155 to 181, answered 234; 313; 392: 40 bytes, one by one
    case = case_of(
        OBJECT,
        [(1, [0]), (2, [0]), (3, [0])],
        shape=(3, 2, 1),
        contention=LINKS,
    )
    outcome = run(implementation, case)
    assert outcome.arrivals[:3] == [
        (155, 0, 1, 0, "request", 8),
        (167, 0, 2, 0, "request", 8),
        (179, 0, 3, 0, "request", 8),
    ]
    assert [end for _, _, end, _ in activities_of(outcome, 0)] == [234, 313, 392]
    assert [arrival[0] for arrival in outcome.arrivals[3:]] == [408, 487, 566]


def test_the_two_links_of_a_ring_of_two(implementation: str) -> None:
    # Requests cross at 13 both ways and arrive at 155: each PE has a link, towards +
    outcome = run(implementation, case_of(OBJECT, [(0, [1]), (1, [0])], contention=LINKS))
    assert outcome.arrivals[:2] == [(155, 0, 1, 0, "request", 8), (155, 1, 0, 0, "request", 8)]


def test_messages_of_one_instant_are_served_by_source_and_number(implementation: str) -> None:
    # Sending is free: all three requests depart at 1 (probe) and meet at PE 1's ejection port
    # 0 to 1  injection 1 to 13, link from 101 to 113, ejection 131: arrives at 143
    # 2 to 1  injection 1, link 101, ejection: its head is there at 131 as well: 155
    # 0 to 1  injection 13, link 113, ejection: its head is there at 143, but waits till 155: 167
    free = CopyCost(0)
    case = case_of(
        OBJECT,
        [(0, [1]), (0, [2]), (2, [1])],
        owners=(0, 1, 1),
        object_bytes=(40, 50, 50),
        shape=(3, 1, 1),
        contention=LINKS,
        send_startup_ps=0,
        pack=(free, free, free, free),
    )
    assert run(implementation, case).arrivals[:3] == [
        (143, 1, 0, 0, "request", 8),
        (155, 1, 2, 0, "request", 8),
        (167, 1, 0, 1, "request", 8),
    ]


def test_who_comes_first_is_served_first_whoever_was_sent_first(implementation: str) -> None:
    # PE 0 asks at 1 for two objects: departures at 13 and, still to come, at 25. PE 2 tests object
    # 0 (a mesh: 7) and asks at 8: departure at 20. At PE 1's ejection port
    # 0 to 1  143, arrives at 155
    # 2 to 1  150, waits till 155: arrives at 167
    # 0 to 1  155, waits till 167: arrives at 179
    case = case_of(
        OBJECT,
        [(0, [1]), (0, [2]), (2, [0, 1])],
        owners=(2, 1, 1),
        object_bytes=(40, 50, 50),
        object_kinds=(MESH, SPHERE, SPHERE),
        shape=(3, 1, 1),
        contention=LINKS,
    )
    assert run(implementation, case).arrivals[:3] == [
        (155, 1, 0, 0, "request", 8),
        (167, 1, 2, 0, "request", 8),
        (179, 1, 0, 1, "request", 8),
    ]
