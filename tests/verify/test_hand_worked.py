"""Tiny machines worked out by hand, to the picosecond: what the oracle and the engines must say.

The costs of messages and of computing are in ``by_hand``.
"""

from __future__ import annotations

from dataclasses import replace

import pytest
from by_hand import EAGER, NEVER_SENDS, OBJECT, RAY, activities_of, case_of
from implementations import IMPLEMENTATIONS, run

from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import CONE, POLYGON, REFLECTED, SHADOW, SPHERE

pytestmark = pytest.mark.parametrize("implementation", IMPLEMENTATIONS)


def test_object_dataflow_fetches_one_object(implementation: str) -> None:
    # PE 0    0 compute: probe 1, object 0 to 1001; object 1 is missing; asks to 1013
    # PE 1 1155 receives the request to 1181, has answered at 1244; 1244 + 184 = 1428
    # PE 0 1428 receives to 1505, compute: probe 1506, object 1 to 2506, the ray's 500 to 3006
    outcome = run(implementation, case_of(OBJECT, [(0, [0, 1])]))
    assert outcome.makespan_ps == 3006
    assert outcome.activities == [
        (0, 0, "compute", 1013, 1),
        (1155, 1, "receive request", 1244, 0),
        (1428, 0, "receive object", 1505, 0),
        (1505, 0, "compute", 3006, 1),
    ]
    assert outcome.arrivals == [(1155, 1, 0, 0, "request", 8), (1428, 0, 1, 0, "object", 50)]
    assert outcome.events == 6
    assert outcome.messages_by_kind == (1, 1, 0, 0)
    assert outcome.messages_received == 2
    assert outcome.bytes_sent == (8 + 4) + (50 + 4)
    assert outcome.compute_ps == [2 * 1000 + 500, 0]
    assert outcome.communication_ps == [1 + 12 + 77 + 1, 26 + 63]
    assert outcome.waiting_ps == [3006 - 2500 - 91, 3006 - 89]
    assert (outcome.rays, outcome.tests, outcome.rays_sent) == (1, 2, 0)
    assert outcome.peak_rays == 1
    assert outcome.peak_bytes == 40 + 50 + 10  # own object, pinned object, one ray
    assert outcome.rules_never_fired == ()


def test_two_rays_share_one_request(implementation: str) -> None:
    # PE 0 compute 0 to 1: both wait for object 1; unpacked at 1 + 504 = 505
    # probe 506, ray 0 to 1506 and 2006, ray 1 to 3006 and 3506
    outcome = run(implementation, case_of(OBJECT, [(0, [1]), (0, [1])]))
    assert outcome.messages_by_kind == (1, 1, 0, 0)
    assert outcome.makespan_ps == 3506
    assert outcome.peak_bytes == 40 + 50 + 2 * 10  # one object pinned for two rays


def test_each_ray_has_its_request(implementation: str) -> None:
    # PE 0    1 asks to 13 and again to 25; arrivals 155 and 167
    # PE 1  155 to 181, answered at 244 (arrives 428); next to 270, answered at 333 (arrives 517)
    # PE 0  428 to 505: only ray 0 is released; probe 506, 1506, 2006
    # PE 0 2006 second object to 2083; probe 2084, 3084, 3584
    policy = replace(OBJECT, merge_requests=False)
    outcome = run(implementation, case_of(policy, [(0, [1]), (0, [1])]))
    assert outcome.messages_by_kind == (2, 2, 0, 0)
    assert activities_of(outcome, 0) == [
        (0, "compute", 25, 0),
        (428, "receive object", 505, 0),
        (505, "compute", 2006, 1),
        (2006, "receive object", 2083, 0),
        (2083, "compute", 3584, 1),
    ]
    assert outcome.makespan_ps == 3584


def test_ray_dataflow_leaves_the_children_at_the_owner(implementation: str) -> None:
    # PE 0    0 compute to 1, sends ray 0 to 25; 25 + 144 = 169
    # PE 1  169 to 207; probe 208, object 1 to 1208, finished 1708; its reflected ray 1 needs
    #           object 0 and waits; its shadow ray 2 runs to 2708, 3208; sends ray 1 to 3232
    # PE 0 3376 to 3414; probe 3415, 4415, 4915
    outcome = run(implementation, case_of(RAY, [(0, [1])], [(0, REFLECTED, [0]), (0, SHADOW, [1])]))
    assert outcome.makespan_ps == 4915
    assert outcome.activities == [
        (0, 0, "compute", 25, 0),
        (169, 1, "receive rays", 207, 0),
        (207, 1, "compute", 3232, 2),
        (3376, 0, "receive rays", 3414, 0),
        (3414, 0, "compute", 4915, 1),
    ]
    assert outcome.messages_by_kind == (0, 0, 2, 0)
    assert (outcome.rays_sent, outcome.bytes_sent) == (2, 2 * (10 + 4))
    assert outcome.compute_ps == [1500, 3000]
    assert outcome.communication_ps == [1 + 24 + 38 + 1, 38 + 1 + 24]
    assert outcome.peak_rays == 2
    assert outcome.tested == [(0, 1), (2, 1), (1, 0)]


def test_rays_are_sent_when_a_batch_waits(implementation: str) -> None:
    # PE 0    0 ray 0 waits, ray 1 runs to 1501; one ray waits, others are ready: not sent
    # PE 0 1501 ray 2 waits, ray 3 runs to 3002; two rays wait: sent to 3036, arrive 3190
    # PE 0 3036 ray 4 to 4537
    # PE 1 3190 to 3238; a quantum of one test each: 4739 and 6240
    policy = replace(RAY, batch=2)
    rays = [(0, [1]), (0, [0]), (0, [1]), (0, [0]), (0, [0])]
    outcome = run(implementation, case_of(policy, rays, quantum=1))
    assert outcome.activities == [
        (0, 0, "compute", 1501, 1),
        (1501, 0, "compute", 3036, 1),
        (3036, 0, "compute", 4537, 1),
        (3190, 1, "receive rays", 3238, 0),
        (3238, 1, "compute", 4739, 1),
        (4739, 1, "compute", 6240, 1),
    ]
    assert outcome.messages_by_kind == (0, 0, 1, 0)
    assert outcome.rays_sent == 2


def test_objects_are_asked_for_when_enough_rays_wait(implementation: str) -> None:
    # as above, but at 3002 PE 0 asks to 3014; ray 4 runs 3015, 4015, 4515
    # PE 1 3156 to 3182, answered 3245, arrives 3429
    # PE 0 4515 receives to 4592; ray 0 to 6093, ray 2 to 7594
    policy = replace(NEVER_SENDS, ask_at_least=2)
    rays = [(0, [1]), (0, [0]), (0, [1]), (0, [0]), (0, [0])]
    outcome = run(implementation, case_of(policy, rays, quantum=1))
    assert activities_of(outcome, 0) == [
        (0, "compute", 1501, 1),
        (1501, "compute", 3014, 1),
        (3014, "compute", 4515, 1),
        (4515, "receive object", 4592, 0),
        (4592, "compute", 6093, 1),
        (6093, "compute", 7594, 1),
    ]
    assert outcome.messages_by_kind == (1, 1, 0, 0)
    assert outcome.rules_never_fired == ("send",)


def test_concurrent_sends_from_the_loaded_and_asks_from_the_idle(implementation: str) -> None:
    # n0 / nb = 2. At 1, PE 0 (load 1 <= 2) asks to 13, PE 1 (load 3 > 2) sends 3 rays to 45
    # PE 1  155 request to 181, answered 244, arrives 428
    # PE 0  209 rays to 267; probe 268, three rays to 4768; then the object to 4845; ray 0 to 6346
    rays = [(0, [1]), (1, [0]), (1, [0]), (1, [0])]
    outcome = run(implementation, case_of(EAGER, rays))
    assert outcome.arrivals == [
        (155, 1, 0, 0, "request", 8),
        (209, 0, 1, 0, "rays", 30),
        (428, 0, 1, 1, "object", 50),
    ]
    assert activities_of(outcome, 0) == [
        (0, "compute", 13, 0),
        (209, "receive rays", 267, 0),
        (267, "compute", 4768, 3),
        (4768, "receive object", 4845, 0),
        (4845, "compute", 6346, 1),
    ]
    assert outcome.makespan_ps == 6346
    assert outcome.peak_rays == 4  # PE 0: ray 0 waits, three are received


STALE = [(0, [0, 2, 3, 1]), (0, [0, 2, 3, 1]), (1, [0]), (1, [1]), (1, [1])]
"""PE 0 holds 2 rays until the end of the story; PE 1 has 2 at 1501 and tells so, 1 at 3014.

PE 1    0 ray 2 waits for object 0, ray 3 runs to 1501; load 2 <= 5 / 2: asks to 1513 (155 -> 1655)
PE 0    0 ray 0: object 0 to 1001; object 2 to 2002
PE 0 2002 request to 2028 (load of PE 1: 2), answered 2081, arrives 2255; object 3 to 3082; waits
PE 1 1513 ray 4 to 3014; object to 3081, ray 2 to 4582
"""


def test_known_load_is_stale(implementation: str) -> None:
    # PE 0 3082 load 2 > 2 heard? no: asks to 3094, arrives 3236; ray 1: 4095, 5096
    # PE 1 4582 request to 4608, answered 4671 (load 0), arrives 4855
    # PE 0 5096 object to 5173; ray 0 to 6674; ray 1: object 3 to 7675, waits; load 1 > 0: sent 7699
    # PE 1 7843 ray to 7881, then 7882, 8882, 9382
    case = case_of(EAGER, STALE, owners=(0, 1, 0, 0), object_bytes=(40, 50, 0, 0), quantum=1)
    outcome = run(implementation, case)
    assert activities_of(outcome, 0) == [
        (0, "compute", 1001, 1),
        (1001, "compute", 2002, 1),
        (2002, "receive request", 2081, 0),
        (2081, "compute", 3094, 1),
        (3094, "compute", 4095, 1),
        (4095, "compute", 5096, 1),
        (5096, "receive object", 5173, 0),
        (5173, "compute", 6674, 1),
        (6674, "compute", 7699, 1),
    ]
    assert outcome.messages_by_kind == (2, 2, 1, 0)
    assert outcome.makespan_ps == 9382


def test_exact_load_is_not_stale(implementation: str) -> None:
    # PE 0 3082 load 2 > 1 (PE 1 since 3014): sends ray 0 to 3106, arrives 3250
    # PE 1 4582 ray to 4620; probe 4621, 5621, 6121
    # PE 0 3106 ray 1: 4107, 5108, 6109; load 1 > 1 (PE 1 at 4620)? no: asks to 6121
    # PE 1 6263 request to 6289, answered 6352; PE 0 6536 object to 6613; 6614, 7614, 8114
    policy = replace(EAGER, load_info="exact")
    case = case_of(policy, STALE, owners=(0, 1, 0, 0), object_bytes=(40, 50, 0, 0), quantum=1)
    outcome = run(implementation, case)
    assert outcome.messages_by_kind == (2, 2, 1, 0)
    assert (3250, 1, 0, 1, "rays", 10) in outcome.arrivals
    assert outcome.makespan_ps == 8114


def test_exact_load_of_a_lower_pe_that_ends_at_the_same_instant(implementation: str) -> None:
    # Both end a compute at 1501. PE 0 has nothing to dispatch and begins again with load 1;
    # then PE 1 decides: load 2 > 1, sends ray 2 to 1525, arrives 1669; ray 4 to 3026
    # PE 0 ray 1 to 3002, receives to 3040; 3041, 4041, 4541
    policy = replace(EAGER, load_info="exact")
    rays = [(0, [0]), (0, [0]), (1, [0]), (1, [1]), (1, [1])]
    outcome = run(implementation, case_of(policy, rays, quantum=1))
    assert outcome.messages_by_kind == (0, 0, 1, 0)
    assert outcome.makespan_ps == 4541


def test_exact_load_of_a_higher_pe_that_ends_at_the_same_instant(implementation: str) -> None:
    # The mirror image: PE 0 decides before PE 1's activity has ended: 2 > 2? no, asks to 1513
    # PE 1 ray 4 to 3002, request to 3028, answered 3091; PE 0 3275 to 3352; 3353, 4353, 4853
    policy = replace(EAGER, load_info="exact")
    rays = [(0, [1]), (0, [0]), (0, [0]), (1, [1]), (1, [1])]
    outcome = run(implementation, case_of(policy, rays, quantum=1))
    assert outcome.messages_by_kind == (1, 1, 0, 0)
    assert outcome.makespan_ps == 4853


def test_transient_memory_forgets_the_least_recently_used(implementation: str) -> None:
    # Room for 2. Fetched 1, 2; test against 1 (hit) makes 2 the oldest; 3 evicts 2; 1 is a hit;
    # 2 has to be fetched again. Each fetch: 504.
    # 1, 505; 506 ray 0: 1506, 2006; 2510; 2511 ray 1: 3511, hit 4511; 5015; 5016 to 6016, 6516;
    # ray 2: hit 7516, 8016; ray 3: 8520; 8521, 9521, 10021
    chain = [(0, REFLECTED, [2, 1, 3]), (1, REFLECTED, [1]), (2, REFLECTED, [2])]
    case = case_of(
        OBJECT,
        [(0, [1])],
        chain,
        owners=(0, 1, 1, 1),
        object_bytes=(40, 50, 50, 50),
        transient=2,
    )
    outcome = run(implementation, case)
    assert outcome.messages_by_kind == (4, 4, 0, 0)
    assert outcome.makespan_ps == 10_021
    assert outcome.compute_ps == [6 * 1000 + 4 * 500, 0]
    assert outcome.communication_ps == [5 * 1 + 4 * (12 + 77), 4 * (26 + 63)]
    assert outcome.peak_bytes == 40 + 2 * 50 + 10


def test_quantum_cuts_a_ray_that_could_go_on_but_not_one_that_is_finished(
    implementation: str,
) -> None:
    # probe 1, 2 tests to 2001: cut; probe 2002, 2 tests to 4002: finished 4502; the child costs no
    # test, but the quantum is used up: probe 4503, 5003. Ray 1 comes last: 5004 and 6004, 6504.
    case = case_of(
        OBJECT,
        [(0, [0, 2, 3, 4]), (0, [0])],
        [(0, SHADOW, [])],
        owners=(0, 1, 0, 0, 0),
        object_bytes=(40, 50, 0, 0, 0),
        quantum=2,
    )
    outcome = run(implementation, case)
    assert outcome.activities == [
        (0, 0, "compute", 2001, 2),
        (2001, 0, "compute", 4502, 2),
        (4502, 0, "compute", 6503, 1),
    ]


@pytest.mark.parametrize(
    ("ready_order", "tests"),
    [("depth-first", [(0, 0), (2, 0), (1, 0)]), ("breadth-first", [(0, 0), (1, 0), (2, 0)])],
)
def test_children_come_first_or_last(
    implementation: str, ready_order: str, tests: list[tuple[int, int]]
) -> None:
    case = case_of(
        OBJECT, [(0, [0]), (0, [0])], [(0, SHADOW, [0])], ready_order=ready_order, quantum=1
    )
    outcome = run(implementation, case)
    assert outcome.tested == tests
    assert outcome.makespan_ps == 3 * 1501


def test_simultaneous_arrivals_are_received_by_source_before_the_pe_computes_on(
    implementation: str,
) -> None:
    # 3 x 2: PE 2 and PE 4 are neighbours of PE 1. They ask at 1 to 13, both arrive at 155, the
    # instant at which its first quantum (probe 1, cone 154) ends: it serves PE 2 to 234, PE 4 to
    # 313, then computes: 314, cone 468, 968. PE 2 408 to 475, 476, 1476, 1976; PE 4 487: 2055
    case = case_of(
        OBJECT,
        [(4, [0]), (1, [1, 2]), (2, [0])],
        owners=(1, 1, 1),
        object_bytes=(40, 50, 50),
        object_kinds=(SPHERE, CONE, CONE),
        shape=(3, 2, 1),
        quantum=1,
    )
    outcome = run(implementation, case)
    assert activities_of(outcome, 1) == [
        (0, "compute", 155, 1),
        (155, "receive request", 234, 0),
        (234, "receive request", 313, 0),
        (313, "compute", 968, 1),
    ]
    assert outcome.arrivals == [
        (155, 1, 2, 0, "request", 8),
        (155, 1, 4, 0, "request", 8),
        (408, 2, 1, 0, "object", 40),
        (487, 4, 1, 1, "object", 40),
    ]
    assert outcome.makespan_ps == 2055


def test_an_unread_message_is_something_else_to_do(implementation: str) -> None:
    # PE 1    1 sends ray 1 to 25, arrives at PE 0 at 169
    # PE 0    0 object 2 to 1001; ray 0 waits for object 1, alone, but the inbox holds ray 1
    # PE 0 1001 receives to 1039, ray 1 is ready; 1040, 2040, 2540: now it sends ray 0, to 2564
    # PE 1 2708 to 2746; 2747, 3747, 4247
    case = case_of(RAY, [(0, [2, 1]), (1, [0])], owners=(0, 1, 0), object_bytes=(40, 50, 0))
    outcome = run(implementation, case)
    assert activities_of(outcome, 0) == [
        (0, "compute", 1001, 1),
        (1001, "receive rays", 1039, 0),
        (1039, "compute", 2564, 1),
    ]
    assert outcome.makespan_ps == 4247


def test_loads_are_refreshed_and_accounts_clipped_at_the_makespan(implementation: str) -> None:
    # PE 0    1 asks to 13, arrives at 155, when PE 1's first test (cone 154) ends
    # PE 1  155 to 181, answered 244, arrives 428; compute 245, polygon 1495, finished 1995
    # PE 0  428 to 505; nothing sent to PE 1 since 13: load to 520, arrives 654; 521, 1521, 2021
    # PE 1 1995 nothing sent to PE 0 since 244: load to 2010, in flight at 2021
    # PE 1 2010 receives PE 0's load until 2039: 11 ps before the end count; it does not answer it
    case = case_of(
        replace(NEVER_SENDS, refresh_ps=400),
        [(0, [1]), (1, [2, 3])],
        owners=(0, 1, 1, 1),
        object_bytes=(40, 50, 0, 0),
        object_kinds=(SPHERE, SPHERE, CONE, POLYGON),
        quantum=1,
    )
    outcome = run(implementation, case)
    assert outcome.makespan_ps == 2021
    assert outcome.messages_by_kind == (1, 1, 0, 2)
    assert outcome.messages_received == 3
    assert outcome.compute_ps == [1500, 154 + 1250 + 500]
    assert outcome.communication_ps == [1 + 12 + 77 + 15 + 1, 1 + 89 + 1 + 15 + 11]
    assert outcome.waiting_ps == [2021 - 1500 - 106, 0]
    assert activities_of(outcome, 1) == [
        (0, "compute", 155, 1),
        (155, "receive request", 244, 0),
        (244, "compute", 2010, 1),
        (2010, "receive load", 2021, 0),
    ]
    assert outcome.arrivals[-1] == (654, 1, 0, 1, "load", 0)
    assert outcome.events == 3 + 4 + 3


@pytest.mark.parametrize(("name", "makespan_ps"), [("object", 3006), ("replicated", 2501)])
def test_replicated_has_everything(implementation: str, name: str, makespan_ps: int) -> None:
    # probe 1, two tests, one ray: 2501, and both objects are in memory from the start
    outcome = run(implementation, case_of(PolicyParameters(name), [(0, [0, 1])]))
    assert outcome.makespan_ps == makespan_ps
    assert outcome.peak_bytes == 40 + 50 + 10


def test_a_torus_costs_its_hops(implementation: str) -> None:
    # 4 x 1 x 1, PE 0 and PE 2 are 2 hops apart: each of the two messages takes 30 ps more
    case = case_of(OBJECT, [(0, [0, 1])], owners=(0, 2), shape=(4, 1, 1))
    assert run(implementation, case).makespan_ps == 3006 + 2 * 30
