"""The recorded rays of one picture: what has to be tested, whoever does it and whenever.

A workload holds no policy and no machine. Rays are numbered generation by generation: first the
primary rays in pixel order, then all children of depth 2 in the order of their parents, and so on,
so the children of a ray are neighbours, by kind with shadow rays, by light, the last.

What only some workloads have stands in arrays that are empty where they don't: then every ray is of
round 0, starts where its pixel is dealt to, and so on.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from simmpp.common.documented import documented

PRIMARY, REFLECTED, REFRACTED, SHADOW, PARTICLE, FORM_FACTOR, DIFFUSE = range(7)
RAY_KINDS = ("primary", "reflected", "refracted", "shadow", "particle", "form_factor", "diffuse")
ROOTS = (PRIMARY, PARTICLE, FORM_FACTOR)
"""Kinds that a ray without a parent may be of; of these only a particle may have one."""
BARREN = (SHADOW, FORM_FACTOR)
"""Kinds that spawn nothing."""
FIRST_REPEATING = PARTICLE
"""From this kind on an itinerary may name an object again: a particle comes back to a cell."""
MOST_TEST_SCALE = 16
"""So that no test takes longer than int64 can count: an object's is at most 2^44 ps."""
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
    """(n,) uint8: an index into RAY_KINDS."""
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
    samples: int = 1
    """Primary rays of each pixel. They are numbered pass after pass: first one of each pixel, row
    by row, then another of each; n0 = samples * rows * columns."""
    root_rounds: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    """(n0,) int32: the roots of round k + 1 start when round k is over, with all descendants. No
    number below the greatest is left out; (0,) if all are of round 0."""
    root_homes: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    """(n0,) int32: the object whose owner starts the root; -1 for one that is dealt with its pixel;
    (0,) if all are."""
    root_weights: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    """(n0,) float64: what the root counts in results, no machine reads it; (0,) if all count 1."""
    ray_test_scales: NDArray[np.uint8] = field(default_factory=lambda: np.zeros(0, np.uint8))
    """(n,) uint8: tests of this ray cost 2^k of the object's; (0,) if all cost as much."""
    object_results: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    """(N,) int64 bytes: of the object's tally, which lives with its owner; (0,) if there is none.
    """
    test_deposits: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    """(tests,) int64 in units of 2^-32: what each test leaves in the tally of its object; (0,)
    where a ray leaves the weight of its root, in what it hits."""
    round_residuals: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    """(rounds,) float64: of what is to be done, the share that is left after each round; (0,) if
    none is told."""

    @property
    def n_rays(self) -> int:
        """Number of rays of all kinds, primary rays and their descendants."""
        return len(self.kinds)

    @property
    def n_primaries(self) -> int:
        """Number of primary rays, n0 in the paper."""
        return self.picture[0] * self.picture[1] * self.samples

    @property
    def n_pixels(self) -> int:
        """Rows times columns; root i is of pixel i mod n_pixels."""
        return self.picture[0] * self.picture[1]

    @property
    def n_rounds(self) -> int:
        """Number of rounds, at least 1."""
        return 1 + int(self.root_rounds.max(initial=0))

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
OPTIONAL = tuple(
    field.name
    for field in dataclasses.fields(Workload)
    if field.default_factory is not dataclasses.MISSING
)
"""Arrays that are empty where they say nothing."""


def frozen(workload: Workload) -> Workload:
    """The same workload with read-only, C-contiguous arrays; the caller's stay as they are."""
    arrays: dict[str, Any] = {}
    for name, value in vars(workload).items():
        if isinstance(value, np.ndarray):
            arrays[name] = np.ascontiguousarray(value).view()  # the caller's flags are left alone
            arrays[name].flags.writeable = False
    return dataclasses.replace(workload, **arrays)
