"""Blocks of PEs in larger blocks, as sets of PEs that are searched."""

from __future__ import annotations

from oracles.costs import Stage, transfer_ps
from simmpp.machine.machine import Level, Machine

Block = tuple[int, ...]


def blocks_of(machine: Machine) -> list[list[Block]]:
    """The blocks of each level as tuples of PEs, from the PEs themselves to the whole."""
    found: list[list[Block]] = [[(pe,) for pe in range(machine.processors)]]
    for level in machine.levels:
        inner = found[-1]
        size = len(inner) if level is machine.levels[-1] else level.size
        parts = [inner[i : i + size] for i in range(0, len(inner), size)]
        found.append([tuple(pe for block in part for pe in block) for part in parts])
    return found


def around(machine: Machine, pe: int) -> list[Block]:
    """The blocks that a PE is in, from itself to the whole."""
    return [next(b for b in blocks if pe in b) for blocks in blocks_of(machine)]


def distance(machine: Machine, source: int, destination: int) -> int:
    """How many times one has to look further around to see both."""
    return next(n for n, block in enumerate(around(machine, source)) if destination in block)


def level_between(machine: Machine, source: int, destination: int) -> Level:
    """The level of the innermost block that has both."""
    return machine.levels[distance(machine, source, destination) - 1]


def way(machine: Machine, source: int, destination: int, n_bytes: int) -> list[Stage]:
    """The ports out of what surrounds the source alone, and into what surrounds the destination."""
    crossed = machine.levels[: distance(machine, source, destination)]

    def port(pe: int, out: str, n: int, then_ps: int) -> Stage:
        level, block = crossed[n], around(machine, pe)[n]
        busy_ps = max(level.gap_ps, transfer_ps(n_bytes, level.bytes_per_s))
        name = (out, level.name, str(block), str(block.index(pe) % level.ports))
        return name, busy_ps, then_ps

    outermost = len(crossed) - 1
    stages = [port(source, "out", n, 0) for n in range(outermost)]
    stages += [port(source, "out", outermost, crossed[-1].latency_ps)]
    stages += [port(destination, "in", n, 0) for n in range(outermost, 0, -1)]
    tail_ps = transfer_ps(n_bytes, crossed[-1].bytes_per_s)
    return [*stages, port(destination, "in", 0, tail_ps)]
