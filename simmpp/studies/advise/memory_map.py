"""What would be best with less or more memory in each node: a map over memory and nodes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from simmpp.common.units import write_bytes
from simmpp.config.config import Config, changed
from simmpp.studies.advise.candidates import Candidate, candidates_on, capacity_of, sizes_of
from simmpp.studies.advise.running import Run
from simmpp.workload.workload import Workload

LEVELS = tuple(Fraction(2) ** n for n in (-2, -1, 0, 1, 2))
"""Times the memory that there is."""
TRIED = 5
"""Setups that are simulated at each place, with one seed."""


class Place(NamedTuple):
    """One number of nodes with one size of their memories."""

    processors: int
    capacity_bytes: int
    best: Candidate | None
    """None: nothing fits, or came to an end."""
    makespan_ps: float


def memory_map(
    config: Config, workload: Workload, ranking: dict[int, list[str]], run: Run
) -> Iterator[Place]:
    """The best of the most promising setups at each place.

    ``ranking`` has the names of setups for each number of nodes, the most promising first.
    """
    capacity = capacity_of(config)
    for level in LEVELS:
        size = max(1, int(level * capacity))
        at = changed(config, [("memory.capacity", write_bytes(size), ("memory", "capacity"))])
        for nodes in sizes_of(config):
            yield _place(at, workload, nodes, size, ranking.get(nodes, []), run)


def _place(
    config: Config, workload: Workload, nodes: int, size: int, ranking: list[str], run: Run
) -> Place:
    fitting = [each for each in candidates_on(config, workload, nodes) if each.fits]
    ranks = {name: n for n, name in enumerate(ranking)}
    fitting.sort(key=lambda each: (ranks.get(each.setup.name, len(ranks)), each.order))
    tried = fitting[:TRIED]
    makespans = run([each.task(0) for each in tried])
    makespan, best = min(zip(makespans, range(len(tried)), strict=True), default=(math.inf, -1))
    if math.isinf(makespan):
        return Place(nodes, size, None, makespan)
    return Place(nodes, size, tried[best], makespan)
