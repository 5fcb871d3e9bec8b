"""The recorded rays of one picture: what has to be tested, whoever does it and whenever.

A workload holds no policy and no machine. Rays are numbered generation by generation: first the
primary rays in pixel order, then all children of depth 2 in the order of their parents, and so on,
so the children of a ray are neighbours, in the order reflected, refracted, shadow by light.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from simmpp.common.documented import documented

PRIMARY, REFLECTED, REFRACTED, SHADOW = range(4)
RAY_KINDS = ("primary", "reflected", "refracted", "shadow")
SPHERE, CONE, POLYGON, MESH = range(4)
OBJECT_KINDS = ("sphere", "cone", "polygon", "mesh")


@documented
@dataclass(frozen=True, eq=False)
class Workload:
    """All rays of a picture with their itineraries (CSR), and what a machine must know of objects.

    Arrays of rays have n entries, arrays of objects N. All are C-contiguous and read-only.
    """

    name: str
    """Label of the scene, e.g. ``mountain:5``."""
    digest: str
    """Hexadecimal hash of everything that made this workload."""
    picture: tuple[int, int]
    """Rows and columns of primary rays; rays 0 ... rows * columns - 1 are primary, row by row."""
    kinds: NDArray[np.uint8]
    """(n,) uint8: PRIMARY, REFLECTED, REFRACTED or SHADOW."""
    parents: NDArray[np.int32]
    """(n,) int32: the ray that spawned this one; -1 for a primary ray."""
    child_offsets: NDArray[np.int32]
    """(n + 1,) int32: children of ray i are rays child_offsets[i] ... child_offsets[i + 1] - 1."""
    pixels: NDArray[np.int32]
    """(n,) int32: the primary ray at the root of this ray's tree."""
    hits: NDArray[np.int32]
    """(n,) int32: the object hit (shadow ray: the first blocker of its itinerary); -1 for none."""
    hit_distances: NDArray[np.float64]
    """(n,) float64: distance of that hit in scene units; inf for none."""
    itinerary_offsets: NDArray[np.int64]
    """(n + 1,) int64: ray i is tested against
    itinerary_objects[itinerary_offsets[i]:itinerary_offsets[i + 1]]."""
    itinerary_objects: NDArray[np.int32]
    """(tests,) int32 object ids, front to back."""
    object_kinds: NDArray[np.uint8]
    """(N,) uint8: SPHERE, CONE, POLYGON or MESH."""
    object_triangles: NDArray[np.int32]
    """(N,) int32: triangles of the object; 0 for spheres and cones."""
    object_bytes: NDArray[np.int64]
    """(N,) int64: size on the wire, without a message's header."""
    object_centroids: NDArray[np.float64]
    """(N, 3) float64: centre of the object, in scene units; owners are placed by it. The tracer's
    are those of boxes, from the scene's least coordinates, rounded so that equal ones are equal."""
    object_test_ps: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    """(N,) int64 picoseconds: what one test of the object costs, whatever its kind; (0,) where the
    machine decides by kind and triangles."""

    @property
    def n_rays(self) -> int:
        """Number of rays of all kinds, primary rays and their descendants."""
        return len(self.kinds)

    @property
    def n_primaries(self) -> int:
        """Number of primary rays, n0 in the paper."""
        return self.picture[0] * self.picture[1]

    @property
    def n_objects(self) -> int:
        """Number N of objects of the scene, tested or not."""
        return len(self.object_kinds)

    @property
    def n_tests(self) -> int:
        """Number of ray-object intersections of the picture."""
        return len(self.itinerary_objects)


ARRAYS: dict[str, type[np.generic]] = {
    name: get_args(get_args(hint)[1])[0]  # NDArray[t] is ndarray[shape, dtype[t]]
    for name, hint in get_type_hints(Workload).items()
    if get_origin(hint) is np.ndarray
}
"""Type of the entries of each array of a workload."""


def frozen(workload: Workload) -> Workload:
    """The same workload with read-only, C-contiguous arrays; the caller's stay as they are."""
    arrays: dict[str, Any] = {}
    for name, value in vars(workload).items():
        if isinstance(value, np.ndarray):
            arrays[name] = np.ascontiguousarray(value).view()  # the caller's flags are left alone
            arrays[name].flags.writeable = False
    return dataclasses.replace(workload, **arrays)
