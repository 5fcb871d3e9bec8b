"""The tiny machine that tests work out by hand, to the picosecond.

All bandwidths are 1 byte per ps. With one hop (100 + 30 ps) and headers of 4 bytes a message costs

    message           sender               network            receiver
    request           10 + 2       =  12   130 +  8 + 4 = 142   20 + 6      = 26
    object, 50 bytes  10 + 3 + 50  =  63   130 + 50 + 4 = 184   20 + 7 + 50 = 77
    object, 40 bytes  10 + 3 + 40  =  53   130 + 40 + 4 = 174   20 + 7 + 40 = 67
    1 ray             10 + 4 + 10  =  24   130 + 10 + 4 = 144   20 + 8 + 10 = 38
    2 rays            10 + 4 + 20  =  34   130 + 20 + 4 = 154   20 + 8 + 20 = 48
    3 rays            10 + 4 + 30  =  44   130 + 30 + 4 = 164   20 + 8 + 30 = 58
    load              10 + 5       =  15   130 +  0 + 4 = 134   20 + 9      = 29

so an object of 50 bytes that an idle owner sends is unpacked 504 ps after the dispatch that asks:
12 + 142 + 26 + 63 + 184 + 77. Computing costs a probe (1), 1000 a test (a sphere) and 500 a ray.
Object 0 has 40 bytes and is PE 0's; object 1 has 50 bytes and is PE 1's.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from builders import Case, placement_of, workload_of
from oracles.ledger import Outcome

from simmpp.machine.machine import UNLIMITED, CopyCost, Machine, TestCost
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import SPHERE

BYTE_PER_PS = 10**12

MACHINE = Machine(
    name="by hand",
    shape=(2, 1, 1),
    send_startup_ps=10,
    receive_startup_ps=20,
    probe_ps=1,
    pack=(CopyCost(2), CopyCost(3, BYTE_PER_PS), CopyCost(4, BYTE_PER_PS), CopyCost(5)),
    unpack=(CopyCost(6), CopyCost(7, BYTE_PER_PS), CopyCost(8, BYTE_PER_PS), CopyCost(9)),
    header_bytes=4,
    request_bytes=8,
    ray_bytes=10,
    latency_ps=100,
    hop_latency_ps=30,
    link_bytes_per_s=BYTE_PER_PS,
    injection_bytes_per_s=UNLIMITED,
    test=TestCost(sphere_ps=1000, cone_ps=154, polygon_ps=1250, mesh_ps=7),
    ray_ps=500,
    quantum=4,
)
OBJECT = PolicyParameters("object")
RAY = PolicyParameters("ray")
EAGER = PolicyParameters("concurrent", min_load=0, batch=1, ask_at_least=1)
NEVER_SENDS = PolicyParameters("concurrent", min_load=100)


def case_of(
    policy: PolicyParameters,
    rays: list[tuple[int, list[int]]],
    children: list[tuple[int, int, list[int]]] | None = None,
    owners: tuple[int, ...] = (0, 1),
    object_bytes: tuple[int, ...] = (40, 50),
    object_kinds: tuple[int, ...] | None = None,
    transient: int = 0,
    ready_order: str = "depth-first",
    **machine: Any,
) -> Case:
    """A case of primary rays (PE, itinerary) and their descendants (parent, kind, itinerary)."""
    children = children or []
    here = replace(MACHINE, **machine)
    workload = workload_of(
        primaries=len(rays),
        itineraries=[i for _, i in rays] + [i for _, _, i in children],
        parents=[parent for parent, _, _ in children],
        kinds=[kind for _, kind, _ in children],
        object_bytes=object_bytes,
        object_kinds=object_kinds or (SPHERE,) * len(owners),
    )
    placement = placement_of(owners, [pe for pe, _ in rays], here.processors, transient=transient)
    return Case(workload, here, placement, policy, ready_order)


def activities_of(outcome: Outcome, pe: int) -> list[tuple[int, str, int, int]]:
    """(begin, kind, end, tests) of one PE's activities."""
    return [(a, kind, b, n) for a, number, kind, b, n in outcome.activities if number == pe]
