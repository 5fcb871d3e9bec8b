"""Particles as a workload: the same whoever follows them, and those of a slow follower."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.particles import Flight, Follower
from particle_cells import preset

from simmpp.common.compiled import njit
from simmpp.common.errors import ConfigError
from simmpp.workload import room
from simmpp.workload.check import check
from simmpp.workload.particles import follow
from simmpp.workload.particles.cells import Cells
from simmpp.workload.particles.functions import log_of, on_circle
from simmpp.workload.particles.grid import ONE
from simmpp.workload.particles.settings import Particles
from simmpp.workload.particles.tracer import digest_of, tallies, trace
from simmpp.workload.workload import ARRAYS, PARTICLE, Workload

SHIELD = preset("shield")
SPLIT = Particles(count=6_000, seed=3, capture="implicit", splitting=True)


@njit
def _logarithms(x: NDArray[np.float64], y: NDArray[np.float64]) -> None:
    for i in range(len(x)):
        y[i] = log_of(x[i])


@njit
def _circle(turns: NDArray[np.float64], y: NDArray[np.float64]) -> None:
    for i in range(len(turns)):
        y[i, 0], y[i, 1] = on_circle(turns[i])


def test_functions_are_those_of_the_library_to_rounding() -> None:
    rng = np.random.default_rng(1)
    x = np.concatenate([(rng.integers(0, 2**32, 20_000) + 0.5) / 2**32, [2**-33, 1 - 2**-33, 1.0]])
    logarithms, circle = np.empty_like(x), np.empty((len(x), 2))
    _logarithms(x, logarithms)
    np.testing.assert_allclose(logarithms, [math.log(each) for each in x], rtol=3e-16, atol=0)
    _circle(x, circle)
    expected = [(math.cos(2 * math.pi * each), math.sin(2 * math.pi * each)) for each in x]
    np.testing.assert_allclose(circle, expected, rtol=0, atol=1e-15)


def contents(workload: Workload) -> list[bytes]:
    return [getattr(workload, name).tobytes() for name in ARRAYS]


CASES: list[tuple[Cells, dict[str, Any]]] = [
    (preset("slab"), {}),
    (preset("slab", mirrors=["-x", "-y", "+y"], source={"low": [0.2, 0.3, 0.5]}), {}),
    (preset("hohlraum"), {"capture": "implicit"}),
    (preset("cube", grid=[3, 5, 4]), {"capture": "implicit"}),
    (SHIELD, {"splitting": True}),
    (SHIELD, {"splitting": True, "capture": "implicit"}),
]


@pytest.mark.parametrize(("cells", "how"), CASES)
def test_cells_and_parts_are_those_of_a_slow_follower(cells: Cells, how: dict[str, Any]) -> None:
    particles = Particles(count=150, seed=11, **how)
    workload, tally = trace(cells, particles), tallies(cells, particles)
    follower = Follower(cells, particles)
    roots = [follower.follow(root) for root in range(particles.count)]
    numbers, absorbed = {id(r[0]): n for n, r in enumerate(roots)}, np.zeros_like(tally.absorbed)
    generation = [flights[0] for flights in roots]
    flights: list[Flight] = []
    while generation:  # numbered as rays are
        flights += generation
        generation = [part for flight in generation for part in flight.children]
        numbers |= {id(part): len(flights) + k for k, part in enumerate(generation)}
    assert workload.n_rays == len(flights)
    for ray, flight in enumerate(flights):
        span = slice(*workload.itinerary_offsets[ray : ray + 2])
        assert workload.itinerary_objects[span].tolist() == flight.cells
        parent = -1 if flight.parent is None else numbers[id(flight.parent)]
        assert workload.parents[ray] == parent
        assert workload.hits[ray] == (-1 if flight.side is not None else flight.cells[-1])
        if flight.side is None:
            assert workload.hit_distances[ray] == pytest.approx(sum(flight.lengths), rel=1e-9)
        np.add.at(absorbed, flight.cells, flight.absorbed)
        absorbed[-1] += flight.roulette
    assert absorbed[:-7].tolist() == tally.absorbed[:-7].tolist()
    assert absorbed[-1] == tally.absorbed[-1]


def test_the_workload_is_sound() -> None:
    workload = trace(SHIELD, SPLIT)
    check(workload, "followed")
    assert (workload.picture, workload.samples) == ((SPLIT.count, 1), 1)
    assert set(workload.kinds) == {PARTICLE}
    assert workload.n_rays > 2 * SPLIT.count
    firsts = workload.itinerary_objects[workload.itinerary_offsets[: SPLIT.count]]
    assert firsts.tolist() == workload.root_homes.tolist()
    assert workload.object_bytes.tolist() == [176 + 80] * 1000


def test_a_segment_goes_on_beside_the_one_before() -> None:
    """Cells of one particle are the same or neighbours; a part begins beside its parent's last."""
    workload = trace(SHIELD, SPLIT)
    objects, offsets = workload.itinerary_objects, workload.itinerary_offsets
    places = np.stack([objects % 10, objects // 10 % 10, objects // 100], axis=1)
    steps = np.abs(np.diff(places, axis=0)).sum(axis=1)
    begins = np.zeros(len(steps), bool)
    begins[offsets[1:-1] - 1] = True
    assert set(steps[~begins]) == {0, 1}
    parts = np.arange(SPLIT.count, workload.n_rays)
    first = places[offsets[parts]]
    last = places[offsets[workload.parents[parts] + 1] - 1]
    assert (np.abs(first - last).sum(axis=1) == 1).all()


def test_whoever_follows_and_however_many(monkeypatch: pytest.MonkeyPatch) -> None:
    """One thread and two, batches and tables of any size: the same bytes, the same sums."""
    workload, tally = trace(SHIELD, SPLIT, threads=1), tallies(SHIELD, SPLIT, threads=1)
    for roots, segments, rays, threads in ((700, 2**20, 2**16, 2), (5000, 50, 9, 1), (1, 3, 1, 2)):
        monkeypatch.setattr(follow, "ROOTS", roots)
        monkeypatch.setattr(follow, "SEGMENTS", segments)
        monkeypatch.setattr(follow, "RAYS_OF", rays)
        assert contents(trace(SHIELD, SPLIT, threads=threads)) == contents(workload)
        again = tallies(SHIELD, SPLIT, threads=threads)
        assert all((a == b).all() for a, b in zip(again[:-1], tally[:-1], strict=True))


def test_fewer_particles_are_the_first_of_more() -> None:
    few = Particles(count=100)
    many = dataclasses.replace(few, count=300)
    one, other = trace(preset("slab"), few), trace(preset("slab"), many)
    assert other.itinerary_objects[: one.n_tests].tolist() == one.itinerary_objects.tolist()
    assert contents(trace(preset("slab"), dataclasses.replace(few, seed=1))) != contents(one)


def test_visits_are_the_tests_of_the_workload() -> None:
    workload, tally = trace(SHIELD, SPLIT), tallies(SHIELD, SPLIT)
    uses = np.bincount(workload.itinerary_objects, minlength=1000)
    assert tally.visits[:-7].tolist() == uses.tolist()


def test_a_digest_is_of_all_that_decides() -> None:
    base, few = preset("hohlraum"), Particles(count=10)
    digests = {digest_of(base, few)}
    for cells, particles in (
        (preset("hohlraum", groups=2), few),
        (preset("hohlraum", mirrors=["-x"]), few),
        (preset("hohlraum", materials={"wall": {"albedo": 0.8}}), few),
        (preset("hohlraum", fineness=2), few),
        (base, Particles(count=11)),
        (base, Particles(count=10, seed=1)),
        (base, Particles(count=10, capture="implicit")),
        (base, Particles(count=10, splitting=True)),
    ):
        digests.add(digest_of(cells, particles))
    assert len(digests) == 9
    assert digest_of(preset("hohlraum"), few) in digests


def test_what_does_not_fit_or_end_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    endless = preset("cube", grid=[2, 2, 2], materials={"matter": {"albedo": 1 - 1e-9}})
    monkeypatch.setattr(follow, "SEGMENTS", 2**10)
    monkeypatch.setattr(follow, "MOST_SEGMENTS", 2**12)
    with pytest.raises(ConfigError, match="particle 0 flies through more than 4096 cells"):
        trace(endless, Particles(count=2))
    monkeypatch.setattr(room, "_bytes_there_are", lambda: 10**6)
    with pytest.raises(ConfigError, match=r"30000 particles take at least .*: expected fewer part"):
        trace(preset("slab"), Particles(count=30_000))
    steep = preset("shield", fineness=1)
    boxes = [box.model_copy(update={"importance": 2**13 if i == 4 else 1})
             for i, box in enumerate(steep.boxes)]  # fmt: skip
    with pytest.raises(ConfigError, match="is split into more than 4096 parts at a time"):
        trace(
            steep.model_copy(update={"boxes": tuple(boxes)}), Particles(count=500, splitting=True)
        )


def test_weights_are_whole_numbers() -> None:
    tally = tallies(preset("slab"), Particles(count=1000, capture="implicit"))
    assert tally.absorbed.dtype == np.int64
    assert tally.absorbed.sum() == 1000 * ONE
