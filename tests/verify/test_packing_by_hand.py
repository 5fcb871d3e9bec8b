"""Messages that carry several things, worked out by hand: what the oracle and the engines must say.

The machine is that of ``by_hand``. The first part of a message pays its startup, and every part its
own packing and unpacking; one header of 4 bytes is for all. With one hop a message costs

    message                sender                     network            receiver
    2 requests             10 + 2 + 2           = 14  130 + 16 + 4 = 150  20 + 6 + 6        =  32
    objects, 50 + 30       10 + (3+50) + (3+30) = 96  130 + 80 + 4 = 214  20 + (7+50)+(7+30) = 114
    objects, 50 + 50       10 + 2 (3+50)       = 116  130 + 100 + 4 = 234 20 + 2 (7+50)     = 134
    2 rays and a request   10 + (4+20) + 2      = 36  130 + 28 + 4 = 162  20 + (8+20) + 6   =  54
"""

from __future__ import annotations

from dataclasses import replace

import pytest
from builders import Case
from by_hand import BYTE_PER_PS, EAGER, NEVER_SENDS, OBJECT, activities_of, case_of
from implementations import IMPLEMENTATIONS, run

from simmpp.machine.machine import CopyCost
from simmpp.policy.parameters import POLICIES, PolicyParameters
from simmpp.policy.policy import Policy
from simmpp.policy.view import View
from simmpp.workload.workload import CONE, POLYGON, REFLECTED, SHADOW, SPHERE

pytestmark = pytest.mark.parametrize("implementation", IMPLEMENTATIONS)

PACKS = replace(OBJECT, packing="requests")
BOTH = pytest.mark.parametrize("packing", ["requests", "all"])


def test_two_requests_share_a_message_and_their_answer(implementation: str) -> None:
    # PE 0    0 compute: probe 1, both rays wait; asks for both to 15, arrives 165
    # PE 1  165 to 197, answers both to 293, arrives 507
    # PE 0  507 to 621: ray 0 is ready, then ray 1 in front of it
    # PE 0  621 probe 622, ray 1 to 1622 and 2122, ray 0 to 3122 and 3622
    rays, objects = [(0, [1]), (0, [2])], {"owners": (0, 1, 1), "object_bytes": (40, 50, 30)}
    outcome = run(implementation, case_of(PACKS, rays, **objects))
    assert outcome.activities == [
        (0, 0, "compute", 15, 0),
        (165, 1, "receive request", 293, 0),
        (507, 0, "receive object", 621, 0),
        (621, 0, "compute", 3622, 2),
    ]
    assert outcome.arrivals == [(165, 1, 0, 0, "request", 16), (507, 0, 1, 0, "object", 80)]
    assert outcome.messages_by_kind == (1, 1, 0, 0)
    assert outcome.parts_by_kind == (2, 2, 0, 0)
    assert outcome.messages_received == 2
    assert outcome.bytes_sent == (16 + 4) + (80 + 4)
    assert outcome.communication_ps == [1 + 14 + 114 + 1, 32 + 96]
    assert outcome.tested == [(1, 2), (0, 1)]
    assert outcome.peak_bytes == 40 + (50 + 30) + 2 * 10  # own object, pinned objects, two rays
    assert [(s.what, s.requests, s.objects, s.payload_bytes) for s in outcome.slices] == [
        ("compute", 0, 0, 0),
        ("send", 2, 0, 16),
        ("receive", 0, 2, 80),
        ("compute", 0, 0, 0),
        ("receive", 2, 0, 16),
        ("send", 0, 2, 80),
    ]


def test_messages_go_round_the_ring_and_their_parts_by_the_oldest_ray(implementation: str) -> None:
    # A ring of 3, PE 1 decides. Copies take half a picosecond a byte, and each part is rounded by
    # itself: 5 for a request of 9 bytes; 21, 16 and 26 for objects of 41, 31 and 51.
    # PE 1    1 asks PE 2 for object 1: 10 + (2+5) = 17, to 18; 130 + 9 + 4: arrives 161
    # PE 1   18 asks PE 0 for 0 and 2: 10 + 2 (2+5) = 24, to 42; 130 + 18 + 4: arrives 194
    # PE 2  161 + 20 + (6+5) = 192, answers 10 + (3+16) = 29, to 221; 130 + 31 + 4: arrives 386
    # PE 0  194 + 20 + 2 (6+5) = 236, answers 10 + (3+21) + (3+26) = 63, to 299; 130 + 92 + 4: 525
    # PE 1  386 + 20 + (7+16) = 429: probe 430, ray 1 to 1430, 1930
    # PE 1 1930 + 20 + (7+21) + (7+26) = 2011: probe 2012, ray 2 to 3012, 3512; ray 0 to 4512, 5012
    case = case_of(
        PACKS,
        [(1, [0]), (1, [1]), (1, [2])],
        owners=(0, 2, 0),
        object_bytes=(41, 31, 51),
        shape=(3, 1, 1),
        request_bytes=9,
        pack=tuple(CopyCost(fixed, BYTE_PER_PS * 2) for fixed in (2, 3, 4, 5)),
        unpack=tuple(CopyCost(fixed, BYTE_PER_PS * 2) for fixed in (6, 7, 8, 9)),
    )
    outcome = run(implementation, case)
    assert outcome.arrivals == [
        (161, 2, 1, 0, "request", 9),
        (194, 0, 1, 1, "request", 18),
        (386, 1, 2, 0, "object", 31),
        (525, 1, 0, 0, "object", 92),
    ]
    assert activities_of(outcome, 1) == [
        (0, "compute", 42, 0),
        (386, "receive object", 429, 0),
        (429, "compute", 1930, 1),
        (1930, "receive object", 2011, 0),
        (2011, "compute", 5012, 2),
    ]
    assert outcome.tested == [(1, 1), (2, 2), (0, 0)]
    assert outcome.parts_by_kind == (3, 3, 0, 0)


def test_unmerged_an_object_rides_once_for_each_request(implementation: str) -> None:
    # PE 0    1 asks twice for object 1 to 15, arrives 165
    # PE 1  165 to 197, answers twice to 313, arrives 547
    # PE 0  547 to 681: each object releases one ray
    # PE 0  681 probe 682, ray 1 to 1682 and 2182, ray 0 to 3182 and 3682
    policy = replace(PACKS, merge_requests=False)
    outcome = run(implementation, case_of(policy, [(0, [1]), (0, [1])]))
    assert outcome.activities == [
        (0, 0, "compute", 15, 0),
        (165, 1, "receive request", 313, 0),
        (547, 0, "receive object", 681, 0),
        (681, 0, "compute", 3682, 2),
    ]
    assert outcome.messages_by_kind == (1, 1, 0, 0)
    assert outcome.parts_by_kind == (2, 2, 0, 0)
    assert outcome.bytes_sent == (16 + 4) + (100 + 4)


ASKS_TWICE = [(0, [1]), (0, [0, 3]), (1, [1]), (1, [1])]
CHILDREN = [(1, REFLECTED, [1]), (1, SHADOW, [2]), (1, SHADOW, [2])]
"""PE 0 asks for object 1 while its second ray is busy; the children of that want 1 and 2, 2.

PE 0    0 probe 1, ray 0 waits for object 1, ray 1: cone 155. Load 2 > 4 / 2? no: asks to 167 (309)
PE 0  167 probe 168, ray 1: cone 322, finished 822; its three children are ready, the load is 4
PE 0  822 probe 823, all three wait. Nothing else to do: load 4 > 2, so the rays that want object 2
          go; the child that wants object 1 can't go as that is in flight, but, unmerged, asks
PE 1    0 probe 1, ray 2 to 1001, 1501; 1501 request to 1527, answered 1590 (1774)
"""


def asks_twice(packing: str) -> Case:
    return case_of(
        replace(EAGER, merge_requests=False, packing=packing),
        ASKS_TWICE,
        CHILDREN,
        owners=(0, 1, 1, 0),
        object_bytes=(40, 50, 30, 40),
        object_kinds=(CONE, SPHERE, SPHERE, CONE),
        quantum=1,
    )


def test_rays_and_a_request_share_a_message(implementation: str) -> None:
    # PE 0  823 packs both to 859, arrives 1021
    # PE 1 1590 receives to 1644, the rays are ready; answered 1707, arrives 1891
    # PE 1 1707 rays 5, 6, 3, each with a probe: 3208, 4709, 6210
    # PE 0 1774 to 1851, ray 0: 1852, 2852, 3352; receives to 3429, ray 4: 3430, 4430, 4930
    outcome = run(implementation, asks_twice("all"))
    assert outcome.arrivals == [
        (309, 1, 0, 0, "request", 8),
        (1021, 1, 0, 1, "rays", 28),
        (1774, 0, 1, 0, "object", 50),
        (1891, 0, 1, 1, "object", 50),
    ]
    assert outcome.activities == [
        (0, 0, "compute", 167, 1),
        (0, 1, "compute", 1501, 1),
        (167, 0, "compute", 822, 1),
        (822, 0, "compute", 859, 0),
        (1501, 1, "receive request", 1590, 0),
        (1590, 1, "receive rays", 1707, 0),
        (1707, 1, "compute", 3208, 1),
        (1774, 0, "receive object", 1851, 0),
        (1851, 0, "compute", 3352, 1),
        (3208, 1, "compute", 4709, 1),
        (3352, 0, "receive object", 3429, 0),
        (3429, 0, "compute", 4930, 1),
        (4709, 1, "compute", 6210, 1),
    ]
    assert [ray for ray, obj in outcome.tested if obj == 2] == [5, 6]
    assert outcome.messages_by_kind == (1, 2, 1, 0)
    assert outcome.parts_by_kind == (2, 2, 1, 0)
    assert (outcome.rays_sent, outcome.bytes_sent) == (2, 12 + 32 + 2 * 54)
    assert outcome.peak_rays == 4  # PE 0; PE 1 holds ray 3 and the two that it receives
    (shared,) = [s for s in outcome.slices if s.what == "send" and s.rays]
    assert (shared.begin, shared.end, shared.load) == (823, 859, 2)
    assert (shared.rays, shared.objects, shared.requests) == (2, 0, 1)


def test_with_requests_packed_rays_go_alone(implementation: str) -> None:
    # PE 0  823 rays to 857 (1011), request to 869 (1011): by the number of the send
    # PE 1 1590 rays to 1638; request to 1664, answered 1727 (1911)
    # PE 1 1727 as above, 20 later: 6230. PE 0 1774 as above to 3352, receives to 3429: 4930
    outcome = run(implementation, asks_twice("requests"))
    assert outcome.arrivals == [
        (309, 1, 0, 0, "request", 8),
        (1011, 1, 0, 1, "rays", 20),
        (1011, 1, 0, 2, "request", 8),
        (1774, 0, 1, 0, "object", 50),
        (1911, 0, 1, 1, "object", 50),
    ]
    assert outcome.makespan_ps == 6230
    assert outcome.messages_by_kind == outcome.parts_by_kind == (2, 2, 1, 0)


@pytest.mark.parametrize(
    ("packing", "arrivals", "makespan_ps"),
    [
        ("none", [(1689, 1, 0, 1, "request", 8), (1689, 2, 0, 0, "rays", 20)], 4739),
        ("requests", [(1689, 1, 0, 1, "request", 8), (1689, 2, 0, 0, "rays", 20)], 4739),
        ("all", [(1655, 1, 0, 0, "request", 8), (1701, 2, 0, 1, "rays", 20)], 4751),
    ],
)
def test_with_all_packed_rays_don_t_come_before_requests(
    implementation: str, packing: str, arrivals: list[object], makespan_ps: int
) -> None:
    # A ring of 3. PE 0 0: rays 0, 1, 2 wait, ray 3 to 1501, and ray 4 is ready: a batch of two goes
    # to PE 2 (34, flight 154), the single ray asks PE 1 (12, flight 142); the load is 5 - 1 - 2
    # none, requests: rays to 1535 (1689), request to 1547 (1689)
    # all:             request to 1513 (1655), rays to 1547 (1701)
    # PE 2 receives for 48; two computes of 1501 each: 4739 or 4751, and no one is later
    case = case_of(
        replace(EAGER, batch=2, packing=packing),
        [(0, [1]), (0, [2]), (0, [2]), (0, [0]), (0, [0])],
        owners=(0, 1, 2),
        object_bytes=(40, 50, 50),
        shape=(3, 1, 1),
        quantum=1,
    )
    outcome = run(implementation, case)
    assert outcome.arrivals[:2] == arrivals
    assert {s.load for s in outcome.slices if s.what == "send" and s.pe == 0} == {2}
    assert outcome.makespan_ps == makespan_ps
    assert outcome.messages_by_kind == outcome.parts_by_kind == (1, 1, 1, 0)


def heard(packing: str) -> Case:
    """PE 0 sends two rays to PE 1, then three to PE 2; PE 1 decides by the load that it heard."""
    return case_of(
        replace(EAGER, ask_at_least=2, packing=packing),
        [(0, [1]), (0, [1]), (0, [2]), (0, [2]), (0, [2]), (1, [3, 0])],
        owners=(0, 1, 2, 1),
        object_bytes=(40, 50, 50, 50),
        object_kinds=(SPHERE, SPHERE, SPHERE, POLYGON),
        shape=(3, 1, 1),
        quantum=1,
        ready_order="breadth-first",
    )


@BOTH
def test_headers_tell_the_load_after_all_rays_have_left(implementation: str, packing: str) -> None:
    # PE 0    1 loads 5 > 6 / 3, 3 > 2: two rays to PE 1, to 35 (189), three to PE 2, to 79 (243)
    # PE 1 1251 its polygon is tested, ray 5 waits; receives to 1299: load 3 > 0 heard, so ray 5
    #           goes to 1323 (1467); its own two to 2824, 4325
    # PE 0 1467 to 1505; 1506, 2506, 3006.   PE 2 243 to 301; 1802, 3303, 4804
    outcome = run(implementation, heard(packing))
    assert outcome.messages_by_kind == outcome.parts_by_kind == (0, 0, 3, 0)
    assert (1467, 0, 1, 0, "rays", 10) in outcome.arrivals
    assert outcome.makespan_ps == 4804


def test_unpacked_a_header_tells_the_load_so_far(implementation: str) -> None:
    # PE 1 1299 load 3 > 3 heard? no; its two rays to 2800 and 4301; asks to 4313 (4455)
    # PE 0 4455 to 4481, answered 4534 (4708); PE 1 4708 to 4775; 4776, 5776, 6276
    outcome = run(implementation, heard("none"))
    assert outcome.messages_by_kind == outcome.parts_by_kind == (1, 1, 2, 0)
    assert outcome.makespan_ps == 6276


def early(view: View) -> bool:
    return view.age_ps < 20


def idle(view: View) -> bool:
    return view.nothing_else != 0


@pytest.mark.parametrize(
    ("packing", "messages"), [("none", (1, 1, 1, 0)), ("requests", (0, 0, 2, 0))]
)
def test_all_is_decided_at_the_time_of_the_dispatch(
    implementation: str,
    packing: str,
    messages: tuple[int, int, int, int],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # PE 0 has nothing heard, 1 ps after the start: a ray goes to PE 1, to 25. What is decided then
    # is decided at 25, 25 >= 20, unless all has been decided before.
    monkeypatch.setitem(POLICIES, "early", Policy("early", send=early, ask=idle))
    policy = PolicyParameters("early", packing=packing)
    places = {"owners": (0, 1, 2), "object_bytes": (40, 50, 50), "shape": (3, 1, 1)}
    outcome = run(implementation, case_of(policy, [(0, [1]), (0, [2])], **places))
    assert outcome.messages_by_kind == messages


@BOTH
def test_a_load_is_refreshed_after_the_messages(implementation: str, packing: str) -> None:
    # PE 0    1 asks for both to 15 (165); PE 1 165 to 197, answers both to 293 (507)
    # PE 0  507 to 621; nothing sent to PE 1 since 15: load to 636, arrives 770
    # PE 0  636 probe 637, ray 1: 1637, 2137, ray 0: 3137, 3637.   PE 1 770 to 799
    policy = replace(NEVER_SENDS, refresh_ps=400, packing=packing)
    objects = {"owners": (0, 1, 1), "object_bytes": (40, 50, 30)}
    outcome = run(implementation, case_of(policy, [(0, [1]), (0, [2])], **objects))
    assert outcome.activities == [
        (0, 0, "compute", 15, 0),
        (165, 1, "receive request", 293, 0),
        (507, 0, "receive object", 636, 0),
        (636, 0, "compute", 3637, 2),
        (770, 1, "receive load", 799, 0),
    ]
    assert outcome.messages_by_kind == (1, 1, 0, 1)
    assert outcome.parts_by_kind == (2, 2, 0, 1)


@pytest.mark.parametrize("merged", [True, False])
def test_a_thousand_parts(implementation: str, merged: bool) -> None:
    # Each of n rays wants an object of its own or, unmerged, asks for the same one
    n = 1000
    policy = replace(PACKS, merge_requests=merged)
    rays = [(0, [1 + ray * merged]) for ray in range(n)]
    owners = (0, *[1] * (n if merged else 1))
    case = case_of(policy, rays, owners=owners, object_bytes=(40, *[50] * (len(owners) - 1)))
    outcome = run(implementation, case)
    asking = 1 + (10 + 2 * n) + (130 + 8 * n + 4)
    answering = (20 + 6 * n) + (10 + (3 + 50) * n) + (130 + 50 * n + 4)
    testing = (20 + (7 + 50) * n) + n // 4 + (1000 + 500) * n
    assert outcome.makespan_ps == asking + answering + testing
    assert outcome.messages_by_kind == (1, 1, 0, 0)
    assert outcome.parts_by_kind == (n, n, 0, 0)
    assert outcome.peak_bytes == 40 + 50 * (n if merged else 1) + 10 * n
    assert outcome.ray_hops == [2] * n
