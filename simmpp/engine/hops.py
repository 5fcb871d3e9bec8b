"""Counts the links that are crossed for each ray, when that is asked for."""

from __future__ import annotations

from simmpp.compiled import njit_reading as njit
from simmpp.engine.layout import Run
from simmpp.engine.memory import ray_hops, rays
from simmpp.machine.torus import hops


@njit
def note_hops(s: Run, first: int, n: int, source: int, destination: int) -> None:
    """A message went from one PE to another for n linked rays."""
    n_hops = hops(s.x, s.y, s.z, source, destination)
    ray = first
    for _ in range(n):
        ray_hops(s)[ray] += n_hops
        ray = rays(s)[ray].next
