"""What a copy or a test costs, by fractions; how far PEs are, by walking over the torus."""

from __future__ import annotations

from collections import deque
from fractions import Fraction
from math import floor

from simmpp.machine.machine import UNLIMITED, CopyCost, Machine
from simmpp.machine.messages import DEPOSIT, RAYS, REQUEST, STEAL, USER
from simmpp.workload.workload import CONE, MESH, POLYGON, SPHERE, Workload

PS_PER_S = 10**12
Stage = tuple[tuple[str, ...], int, int]
"""A link or port by its name; how long a message keeps it; when its head is at the next one, or the
message is there: after how long."""


def transfer_ps(n_bytes: int, bytes_per_s: int) -> int:
    """Time that bytes take at a bandwidth, halves rounded up."""
    if bytes_per_s == UNLIMITED:
        return 0
    return floor(Fraction(n_bytes * PS_PER_S, bytes_per_s) + Fraction(1, 2))


def slowest(machine: Machine) -> int:
    """The bandwidth of links and ports that are all alike."""
    limits = (machine.link_bytes_per_s, machine.injection_bytes_per_s)
    return min((b for b in limits if b != UNLIMITED), default=UNLIMITED)


def copy_ps(cost: CopyCost, payload_bytes: int) -> int:
    """Time to pack or unpack one message."""
    return cost.fixed_ps + transfer_ps(payload_bytes, cost.bytes_per_s)


def packing(machine: Machine, kind: int, payload_bytes: int) -> int:
    """Time to pack a part of a message; what is got, and getting it, needs none."""
    return _copying(machine, machine.pack, kind, payload_bytes)


def unpacking(machine: Machine, kind: int, payload_bytes: int) -> int:
    """Time to unpack a part of a message."""
    return _copying(machine, machine.unpack, kind, payload_bytes)


def _copying(machine: Machine, costs: tuple[CopyCost, ...], kind: int, n_bytes: int) -> int:
    if machine.service == "nic" and kind not in (RAYS, USER, STEAL, DEPOSIT):
        return 0
    alike = {USER: REQUEST, STEAL: REQUEST, DEPOSIT: RAYS}
    return copy_ps(costs[alike.get(kind, kind)], n_bytes)


def intersection_ps(machine: Machine, workload: Workload, obj: int, ray: int = -1) -> int:
    """Time of one ray-object intersection, of a ray or of one that costs no more than others."""
    if ray >= 0 and len(workload.ray_test_scales):
        return _of_object(machine, workload, obj) * 2 ** int(workload.ray_test_scales[ray])
    return _of_object(machine, workload, obj)


def _of_object(machine: Machine, workload: Workload, obj: int) -> int:
    kind, triangles = int(workload.object_kinds[obj]), int(workload.object_triangles[obj])
    test = machine.test
    base = {
        SPHERE: test.sphere_ps,
        CONE: test.cone_ps,
        POLYGON: test.polygon_ps,
        MESH: test.mesh_ps,
    }[kind]
    if test.log2_ps:
        depth = next(k for k in range(64) if 2**k >= triangles)
        return base + test.log2_ps * depth
    return base + test.per_triangle_ps * max(triangles - 1, 0)


def neighbours(shape: tuple[int, int, int], pe: int) -> list[int]:
    """PEs that a link leads to from this PE."""
    x_size, y_size, z_size = shape
    x, y, z = pe % x_size, pe // x_size % y_size, pe // (x_size * y_size)
    found = []
    for step in (1, -1):
        for dx, dy, dz in ((step, 0, 0), (0, step, 0), (0, 0, step)):
            there = ((x + dx) % x_size, (y + dy) % y_size, (z + dz) % z_size)
            found.append(there[0] + x_size * (there[1] + y_size * there[2]))
    return found


def hops_from(shape: tuple[int, int, int], pe: int) -> dict[int, int]:
    """Links on the shortest way from a PE to every PE, by breadth-first search."""
    hops, queue = {pe: 0}, deque([pe])
    while queue:
        here = queue.popleft()
        for there in neighbours(shape, here):
            if there not in hops:
                hops[there] = hops[here] + 1
                queue.append(there)
    return hops
