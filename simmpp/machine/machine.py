"""The machine, in the integers that a simulation runs on: picoseconds, bytes, bytes per second."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.common.units import UNLIMITED as UNLIMITED
from simmpp.machine.torus import NO_CONTENTION
from simmpp.workload.workload import CONE, MESH, POLYGON, SPHERE, Workload


@dataclass(frozen=True)
class CopyCost:
    """Cost of packing or unpacking one message of a kind: fixed + payload bytes / bandwidth."""

    fixed_ps: int = 0
    bytes_per_s: int = UNLIMITED


@dataclass(frozen=True)
class TestCost:
    """Cost of one ray-object intersection, by kind of primitive."""

    __test__ = False  # not a test class, whatever pytest thinks of the name

    sphere_ps: int
    cone_ps: int
    polygon_ps: int
    mesh_ps: int
    per_triangle_ps: int = 0
    """Added for every triangle of a polygon or mesh beyond its first."""

    def of_objects(self, workload: Workload, dtype: type = np.int64) -> NDArray[Any]:
        """Cost of a test against each object, its own where the workload gives one: (N,) ps."""
        if len(workload.object_test_ps):
            return workload.object_test_ps.astype(dtype)
        by_kind: NDArray[Any] = np.zeros(4, dtype)
        by_kind[[SPHERE, CONE, POLYGON, MESH]] = (
            self.sphere_ps,
            self.cone_ps,
            self.polygon_ps,
            self.mesh_ps,
        )
        beyond_first = np.maximum(workload.object_triangles.astype(dtype) - 1, 0)
        return by_kind[workload.object_kinds] + self.per_triangle_ps * beyond_first


@dataclass(frozen=True)
class Machine:
    """Constants of one machine; ``shape`` says how many PEs it has.

    Copy costs are indexed by message kind: request, object, rays, load.
    """

    name: str
    shape: tuple[int, int, int]
    """PEs along x, y, z of the torus; PE k = x + X (y + Y z)."""
    send_startup_ps: int
    receive_startup_ps: int
    probe_ps: int
    """Looking into an empty inbox before computing."""
    pack: tuple[CopyCost, CopyCost, CopyCost, CopyCost]
    unpack: tuple[CopyCost, CopyCost, CopyCost, CopyCost]
    header_bytes: int
    request_bytes: int
    ray_bytes: int
    latency_ps: int
    hop_latency_ps: int
    link_bytes_per_s: int
    injection_bytes_per_s: int
    test: TestCost
    ray_ps: int
    """Set-up and shading of one ray."""
    quantum: int
    """Tests that a PE computes at most before it looks into its inbox."""
    contention: str = NO_CONTENTION
    """What messages wait for: "none", or "links" (see ``machine.links``)."""
    sources: dict[str, str] = field(default_factory=dict, compare=False)
    """Where each constant comes from, by its dotted key; values without a document say ESTIMATE."""

    @property
    def processors(self) -> int:
        """Number of PEs, nb in the paper."""
        x, y, z = self.shape
        return x * y * z
