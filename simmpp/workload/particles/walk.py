"""Follows particles: what each segment leaves in its cell, and where a particle ends or splits."""

from __future__ import annotations

import numpy as np

from simmpp.common.compiled import kernel, njit
from simmpp.workload.particles.flight import (
    Particle,
    cell_of,
    crossed,
    draw,
    emitted,
    scattered,
    side_ahead,
    sigma_of,
)
from simmpp.workload.particles.functions import log_of
from simmpp.workload.particles.grid import Grid, Longs, Rules
from simmpp.workload.particles.settings import SURVIVORS
from simmpp.workload.particles.tables import (
    BRANCHES,
    CELLS,
    FULL,
    HEIGHT,
    LOST,
    PARTS,
    RAYS,
    TOUCHED,
    Ints,
    Parts,
    Tables,
    Tally,
    fold,
    left,
    visit,
)
from simmpp.workload.trace.vectors import moved, vector

FLIES, ENDS, LEAVES, SPLITS = range(4)
"""What comes of a segment."""


@njit
def homes(grid: Grid, seed: int, count: int) -> Ints:
    """The cell in which each root begins, (count,) int32."""
    cells = np.empty(count, np.int32)
    for root in range(count):
        cells[root] = cell_of(grid, emitted(grid, seed, root).place)
    return cells


@njit
def walk(
    grid: Grid,
    rules: Rules,
    first: int,
    last: int,
    tables: Tables,
    one: Tally,
    all_: Tally,
    parts: Parts,
) -> int:
    """Follow roots first ... last - 1 as far as the tables hold; the first that they do not."""
    counters = tables.counters
    for root in range(first, last):
        cells, rays = counters[CELLS], counters[RAYS]
        counters[TOUCHED] = 0
        if not _tree(grid, rules, root, tables, one, parts):
            counters[CELLS], counters[RAYS] = cells, rays
            fold(one, all_, counters[TOUCHED], False)
            return root
        fold(one, all_, counters[TOUCHED], True)
    return last


@kernel
def _tree(grid: Grid, rules: Rules, root: int, tables: Tables, one: Tally, parts: Parts) -> bool:
    """Follow a root and all its parts; False if the tables are full."""
    counters = tables.counters
    counters[HEIGHT], counters[BRANCHES] = 0, 1
    particle = emitted(grid, rules.seed, root)
    if not _ray(grid, rules, root, particle, -1, 0, tables, one, parts):
        return False
    while counters[HEIGHT] > 0:
        counters[HEIGHT] -= 1
        k, branch = counters[HEIGHT], counters[BRANCHES]
        counters[BRANCHES] = branch + 1
        i, j, n, weight, parent, depth = parts.numbers[k]
        at, direction = vector(parts.vectors[:, :3], k), vector(parts.vectors[:, 3:], k)
        _, _, _, u = draw(rules.seed, root, branch, 0, 0)
        particle = Particle(at, direction, (i, j, n), weight, -log_of(u), branch, 0)
        if not _ray(grid, rules, root, particle, parent, depth, tables, one, parts):
            return False
    return True


@kernel
def _ray(
    grid: Grid,
    rules: Rules,
    root: int,
    particle: Particle,
    parent: int,
    depth: int,
    tables: Tables,
    one: Tally,
    parts: Parts,
) -> bool:
    """Follow one particle until it ends, leaves or splits; False if the tables are full."""
    counters = tables.counters
    ray, start, far, outcome, cell = counters[RAYS], counters[CELLS], 0.0, FLIES, 0
    if ray == len(tables.hits):
        return False
    counters[RAYS] = ray + 1
    while outcome == FLIES:
        at = counters[CELLS]
        if at == len(tables.cells):
            return False
        counters[CELLS], cell = at + 1, cell_of(grid, particle.place)
        weight = particle.weight
        visit(one, counters, cell)
        particle, length, outcome = _segment(grid, rules, root, particle, cell, counters, one)
        track = int(weight * (length / grid.unit) + 0.5)
        one.tracks[cell] += track
        tables.cells[at], tables.tracks[at] = cell, track
        far += length
    tables.parents[ray], tables.depths[ray] = parent, depth
    tables.n_tests[ray] = counters[CELLS] - start
    leaves = outcome == LEAVES
    tables.hits[ray], tables.distances[ray] = -1 if leaves else cell, np.inf if leaves else far
    if outcome == SPLITS:
        return _split(grid, particle, cell, ray, depth + 1, counters, parts)
    return True


@kernel
def _segment(
    grid: Grid, rules: Rules, root: int, particle: Particle, cell: int, counters: Longs, one: Tally
) -> tuple[Particle, float, int]:
    """To the next collision or side: the particle there, how far it is, and what comes of it."""
    distance, side = side_ahead(grid, particle)
    sigma = sigma_of(grid, particle.place)
    if sigma * distance > particle.ahead:
        length = particle.ahead / sigma
        beyond, outcome = _collided(grid, rules, root, particle, length, cell, counters, one)
        return beyond, length, outcome
    beyond, stays = crossed(grid, particle, distance, side)
    if not stays:
        left(one, counters, len(grid.material_of) + side, particle.weight)
        return beyond, distance, LEAVES
    if not rules.splitting:
        return beyond, distance, FLIES
    old, new = grid.importances[cell], grid.importances[cell_of(grid, beyond.place)]
    if new > old:
        return beyond, distance, SPLITS
    if new < old:
        beyond = _thinned(grid, rules, root, beyond, old // new, counters, one)
    return beyond, distance, FLIES if beyond.weight > 0 else ENDS


@kernel
def _collided(
    grid: Grid,
    rules: Rules,
    root: int,
    particle: Particle,
    length: float,
    cell: int,
    counters: Longs,
    one: Tally,
) -> tuple[Particle, int]:
    """The particle behind a collision, if it goes on."""
    event, weight = particle.event + 1, particle.weight
    chance, u, v, w = draw(rules.seed, root, particle.branch, event, 0)
    material = grid.material_of[cell]
    albedo, g = grid.materials[material, 1], grid.materials[material, 2]
    kept = int(weight * albedo + 0.5) if rules.implicit else (weight if chance < albedo else 0)
    one.absorbed[cell] += weight - kept
    position = moved(particle.position, length, particle.direction)
    direction = scattered(particle.direction, g, u, v)
    beyond = Particle(position, direction, particle.place, kept, -log_of(w), particle.branch, event)
    if rules.implicit and 0 < kept < rules.least:
        beyond = _thinned(grid, rules, root, beyond, SURVIVORS, counters, one)
    return beyond, FLIES if beyond.weight > 0 else ENDS


@kernel
def _thinned(
    grid: Grid, rules: Rules, root: int, particle: Particle, n: int, counters: Longs, one: Tally
) -> Particle:
    """One of ``n`` particles goes on, with n times the weight; else none."""
    event = particle.event + 1
    chance, _, _, _ = draw(rules.seed, root, particle.branch, event, 0)
    weight = particle.weight * n if chance * n < 1.0 else 0
    left(one, counters, len(grid.material_of) + LOST, particle.weight - weight)
    return Particle(
        particle.position,
        particle.direction,
        particle.place,
        weight,
        particle.ahead,
        particle.branch,
        event,
    )


@kernel
def _split(
    grid: Grid, particle: Particle, cell: int, ray: int, depth: int, counters: Longs, parts: Parts
) -> bool:
    """Let the parts wait, the first of them on top; False if they are too many."""
    n = grid.importances[cell_of(grid, particle.place)] // grid.importances[cell]
    height = counters[HEIGHT]
    if height + n > PARTS:
        counters[FULL] = 1
        return False
    for i in range(n):
        k = height + n - 1 - i
        weight = particle.weight // n + (1 if i < particle.weight % n else 0)
        for axis in range(3):
            parts.vectors[k, axis] = particle.position[axis]
            parts.vectors[k, 3 + axis] = particle.direction[axis]
            parts.numbers[k, axis] = particle.place[axis]
        parts.numbers[k, 3], parts.numbers[k, 4], parts.numbers[k, 5] = weight, ray, depth
    counters[HEIGHT] = height + n
    return True
