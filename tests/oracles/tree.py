"""The fat-tree as a graph: switches by what is below them, and a walk from one to the next.

A switch is known by its level, the PEs below it, and the number of each choice of a link up that
leads to it.
"""

from __future__ import annotations

from typing import NamedTuple

from oracles.costs import Stage, slowest, transfer_ps
from simmpp.machine.machine import Machine


class Node(NamedTuple):
    """A PE (level 0) or a switch."""

    level: int
    pes: range
    """Numbers of the PEs below, of a tree that has them all."""
    choices: tuple[int, ...] = ()
    """Which link up was taken from levels 0, 1, ... to get here."""


def parent(arity: int, node: Node, choice: int) -> Node:
    """Where a link up leads."""
    size = arity ** (node.level + 1)
    first = node.pes.start - node.pes.start % size
    return Node(node.level + 1, range(first, first + size), (*node.choices, choice))


def child(arity: int, node: Node, pe: int) -> Node:
    """Where the link down leads that a PE is below."""
    size = arity ** (node.level - 1)
    first = next(n for n in range(node.pes.start, node.pes.stop, size) if pe in range(n, n + size))
    return Node(node.level - 1, range(first, first + size), node.choices[:-1])


def walk(machine: Machine, source: int, destination: int) -> list[tuple[Node, Node]]:
    """Links from one PE to another as pairs of nodes."""
    arity = machine.fat_tree.arity
    ups = arity // machine.fat_tree.oversubscription
    here, links = Node(0, range(source, source + 1)), []
    ways_below = 1
    while destination not in here.pes:
        n_ways = 1 if here.level == 0 else ups
        there = parent(arity, here, destination // ways_below % n_ways)
        links.append((here, there))
        here, ways_below = there, ways_below * n_ways
    while here.level > 0:
        there = child(arity, here, destination)
        links.append((here, there))
        here = there
    return links


def distance(machine: Machine, source: int, destination: int) -> int:
    """Links between two PEs."""
    return len(walk(machine, source, destination))


def way(machine: Machine, source: int, destination: int, n_bytes: int) -> list[Stage]:
    """Links with those of the PEs, which are their ports; the latency is paid at the start."""
    links, hop_ps = walk(machine, source, destination), machine.hop_latency_ps
    busy_ps = transfer_ps(n_bytes, slowest(machine))
    stages = []
    for link in links:
        gap_ps = machine.port_gap_ps if any(node.level == 0 for node in link) else 0
        stages.append((tuple(map(str, link)), max(busy_ps, gap_ps), hop_ps))
    (first, held_ps, _), *between, (last, last_held_ps, _) = stages
    start = (first, held_ps, hop_ps + machine.latency_ps + hop_ps)
    return [start, *between, (last, last_held_ps, busy_ps)]
