"""Did the simulated processors make the picture? Their tests are done again, one by one.

Only the (ray, object) pairs that they tested are intersected, exactly and object by object; what
these find must be what the workload records, ray by ray, and give the sequential picture.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit
from simmpp.scene.scene import Scene
from simmpp.workload.picture import Picture
from simmpp.workload.trace.exact import entry, hit_object, ray_of
from simmpp.workload.trace.frame import Frame
from simmpp.workload.trace.geometry import Geometry
from simmpp.workload.trace.itineraries import Work, work_for
from simmpp.workload.trace.ray_batch import RayBatch
from simmpp.workload.trace.replay import SpawnError, Traced, recorded_generations, traced
from simmpp.workload.trace.shading import shade
from simmpp.workload.workload import SHADOW, Workload

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


@dataclass(frozen=True)
class Difference:
    """The first difference between the sequential picture and that of the tests."""

    row: int
    column: int
    reason: str
    expected: tuple[int, int, int] | None = None
    """Colour of the pixel in the sequential picture; equal to ``obtained`` if only tests differ;
    None if the workload records no picture."""
    obtained: tuple[int, int, int] | None = None

    def __str__(self) -> str:
        colours = f"expected {self.expected}, got {self.obtained}: " if self.expected else ""
        return f"pixel ({self.row}, {self.column}): {colours}{self.reason}"


def verify(
    scene: Scene, picture: Picture, workload: Workload, tested_rays: Ints, tested_objects: Ints
) -> Difference | None:
    """The first difference, or None if the tests make the recorded picture, bit for bit.

    Parameters
    ----------
    tested_rays, tested_objects : (k,) int32, the tests that were made, in any order

    Raises
    ------
    WorkloadError
        The workload is not of this scene and picture.
    """
    replayed = traced(scene, picture, workload)
    try:
        return _compared(replayed, tested_rays, tested_objects)
    except SpawnError as error:
        return Difference(*_pixel_of(error.ray, replayed), error.problem)


def _compared(replayed: Traced, tested_rays: Ints, tested_objects: Ints) -> Difference | None:
    workload = replayed.workload
    problem = wrong_test(workload, tested_rays, tested_objects)
    hits, distances = hits_of_tests(replayed, tested_rays, tested_objects)
    problem = problem or _wrong_hit(workload, hits, distances)
    return _difference(replayed, hits, problem)


def problem_of_roots(
    workload: Workload,
    geometry: Geometry,
    frame: Frame,
    rays: RayBatch,
    tested_rays: Ints,
    tested_objects: Ints,
) -> str:
    """What is wrong with the tests of ``rays`` that are all roots and spawn nothing; else empty."""
    found = _hits_of_tests(workload, geometry, [(0, rays)], tested_rays, tested_objects)
    wrong = _wrong_hit(workload, found[0], frame.scene_lengths(found[1]))
    _, problem = wrong_test(workload, tested_rays, tested_objects) or wrong or (0, "")
    return problem


def _wrong_hit(workload: Workload, hits: Ints, distances: Floats) -> tuple[int, str] | None:
    """The first ray whose hit is not the recorded one; None if all are."""
    wrong = (hits != workload.hits) | (distances != workload.hit_distances)
    if not wrong.any():
        return None
    ray = int(wrong.argmax())
    obtained = f"its tests hit object {hits[ray]} at {distances[ray]!r}"
    recorded = f"{workload.hits[ray]} at {workload.hit_distances[ray]!r} is recorded"
    return ray, f"ray {ray}: {obtained}, {recorded}"


def hits_of_tests(replayed: Traced, tested_rays: Ints, tested_objects: Ints) -> tuple[Ints, Floats]:
    """What the tests find: hits (n,) int32, -1 for none, and distances (n,) float64, scene units.

    A ray takes the nearest hit of its tests, a shadow ray the blocker whose box it enters first,
    ties by object. Rays are recomputed generation by generation from the recorded hits, so the
    answer of a ray is meaningful if its ancestors' hits are the recorded ones. Tests of rays and
    objects that do not exist find nothing.
    """
    workload, generations = replayed.workload, recorded_generations(replayed)
    tests = tested_rays, tested_objects
    hits, distances = _hits_of_tests(workload, replayed.geometry, generations, *tests)
    return hits, replayed.frame.scene_lengths(distances)


def _hits_of_tests(
    workload: Workload,
    geometry: Geometry,
    generations: Iterable[tuple[int, RayBatch]],
    tested_rays: Ints,
    tested_objects: Ints,
) -> tuple[Ints, Floats]:
    """The same, normalised; ``generations`` as :func:`~.replay.recorded_generations` has them."""
    hits, distances = np.full(workload.n_rays, -1, np.int32), np.full(workload.n_rays, np.inf)
    places, work = np.full(workload.n_rays, np.inf), work_for(geometry.shapes)
    exists = (tested_objects >= 0) & (tested_objects < workload.n_objects)
    for start, rays in generations:
        stop = start + len(rays.kinds)
        mine = np.flatnonzero(exists & (tested_rays >= start) & (tested_rays < stop))
        # By object, so that its triangles stay in the CPU's cache from one test to the next.
        by_object = mine[np.argsort(tested_objects[mine], kind="stable")]
        _intersect_pairs(
            geometry,
            rays,
            tested_rays[by_object] - np.int32(start),
            tested_objects[by_object],
            hits[start:stop],
            distances[start:stop],
            places[start:stop],
            work,
        )
    return hits, distances


@njit
def _intersect_pairs(
    geometry: Geometry,
    rays: RayBatch,
    tested_rays: Ints,
    tested_objects: Ints,
    hits: Ints,
    distances: Floats,
    places: Floats,
    work: Work,
) -> None:
    """Intersect pairs of a generation; the first hit of each ray is that of the least place."""
    for k in range(len(tested_rays)):
        i, o = tested_rays[k], tested_objects[k]
        ray = ray_of(rays.origins, rays.directions, i)
        enter = entry(geometry.boxes, o, ray)
        t, _ = hit_object(geometry.shapes, o, ray, enter, np.inf, work.inner)
        if o == rays.sources[i] or not t < rays.limits[i]:
            continue
        place = enter if rays.kinds[i] == SHADOW else t
        if place < places[i] or (place == places[i] and o < hits[i]):
            hits[i], distances[i], places[i] = o, t, place


def wrong_test(
    workload: Workload, tested_rays: Ints, tested_objects: Ints
) -> tuple[int, str] | None:
    """The first ray that misses a test of its itinerary or has one too many; None if none does."""
    # A test as one number, which sorts by ray and then by object.
    tested = np.int64(1 << 32) * tested_rays + tested_objects
    rays = np.repeat(np.arange(workload.n_rays), np.diff(workload.itinerary_offsets))
    expected = np.sort(np.int64(1 << 32) * rays + workload.itinerary_objects)
    tested.sort()
    common = min(len(tested), len(expected))
    differs = np.flatnonzero(tested[:common] != expected[:common])
    first = int(differs[0]) if len(differs) else common
    if first == max(len(tested), len(expected)):
        return None
    extra = first == len(expected) or (first < len(tested) and tested[first] < expected[first])
    pair = int(tested[first] if extra else expected[first])
    ray, item = pair >> 32, pair & 0xFFFFFFFF
    often, too_often = ("", ", once too often") if extra else ("never ", "")
    return ray, f"ray {ray} is {often}tested against object {item}{too_often}"


def _difference(replayed: Traced, hits: Ints, problem: tuple[int, str] | None) -> Difference | None:
    """Where the pictures differ first, else where the ray of ``problem`` belongs."""
    expected, obtained = shade(replayed, replayed.workload.hits.copy()), shade(replayed, hits)
    places = np.argwhere((expected != obtained).any(axis=2))
    if problem is None and not len(places):
        return None
    ray, reason = problem or (0, "the pictures differ")
    row, column = (int(k) for k in places[0]) if len(places) else _pixel_of(ray, replayed)
    return Difference(
        row, column, reason, _colour(expected[row, column]), _colour(obtained[row, column])
    )


def _pixel_of(ray: int, replayed: Traced) -> tuple[int, int]:
    """Row and column of the picture that a ray belongs to."""
    workload = replayed.workload
    pixel = int(workload.pixels[min(max(ray, 0), workload.n_rays - 1)]) % workload.n_pixels
    rows, columns = replayed.picture.pixels
    row, column = divmod(pixel, workload.picture[1])
    return min(row, rows - 1), min(column, columns - 1)


def _colour(pixel: NDArray[np.uint8]) -> tuple[int, int, int]:
    red, green, blue = (int(channel) for channel in pixel)
    return red, green, blue
