"""What a message costs on its way in the mean, if every PE sends as much to each of the others.

Rows know how many messages were sent, but not between whom: who sends to neighbours has cheaper
ones, who sends to one hot PE dearer or cheaper ones.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import accumulate
from math import prod
from typing import Any, NamedTuple

from simmpp.machine.machine import FAT_TREE

STARTUPS = ("send_startup_ps", "receive_startup_ps")


class Flight(NamedTuple):
    """Means over all pairs of different PEs."""

    startups_ps: int
    """Of both PEs."""
    latency_ps: int
    bytes_per_s: int
    """That of the mean time of a byte; 0: unlimited."""


def mean_flight(constants: Mapping[str, Any]) -> Flight:
    """Of a machine's fields, as ``run.json`` has them; KeyError where these were others."""
    nb, levels = prod(constants["shape"]), constants.get("levels")
    startups_ps = sum(constants[name] for name in STARTUPS)
    if levels:
        return _of_levels(constants, levels, nb, startups_ps)
    rates = [constants["link_bytes_per_s"], constants["injection_bytes_per_s"]]
    if constants.get("topology") == FAT_TREE:
        hops = _hops_in_tree(nb, constants["fat_tree"]["arity"])
    else:
        hops = _hops_in_torus(constants["shape"])
    latency_ps = constants["latency_ps"] + round(hops * constants["hop_latency_ps"])
    return Flight(startups_ps, latency_ps, min(filter(None, rates), default=0))


def _of_levels(
    constants: Mapping[str, Any], levels: Sequence[Mapping[str, Any]], nb: int, startups_ps: int
) -> Flight:
    blocks = list(accumulate((level["size"] for level in levels[:-1]), int.__mul__))
    shares = shares_of_pairs(nb, [*blocks, nb])
    means = {"latency_ps": 0.0, "startups_ps": 0.0, "s_per_byte": 0.0}
    for share, level in zip(shares, levels, strict=True):
        rate = level["bytes_per_s"]
        means["latency_ps"] += share * level["latency_ps"]
        means["startups_ps"] += share * sum(level.get(n, constants[n]) for n in STARTUPS)
        means["s_per_byte"] += share / rate if rate else 0.0
    rate = round(1 / means["s_per_byte"]) if means["s_per_byte"] else 0
    return Flight(round(means["startups_ps"]), round(means["latency_ps"]), rate)


def shares_of_pairs(nb: int, blocks: Sequence[int]) -> list[float]:
    """Of all pairs of different PEs those whose innermost common block is of each size.

    The last block has all ``nb`` PEs; those before may be cut short at the end of the row.
    """
    within = [nb // size * size * (size - 1) + nb % size * (nb % size - 1) for size in blocks]
    if not within[-1]:
        return [0.0] * (len(blocks) - 1) + [1.0]
    return [(n - inner) / within[-1] for n, inner in zip(within, (0, *within), strict=False)]


def _hops_in_torus(shape: Sequence[int]) -> float:
    """Links between two different PEs: (n^2 // 4) / n along a ring of n, with itself."""
    nb = prod(shape)
    return sum(n * n // 4 / n for n in shape) * nb / (nb - 1) if nb > 1 else 0.0


def _hops_in_tree(nb: int, arity: int) -> float:
    """Up to the first switch that has both PEs below it, and as many down."""
    height = next(n for n in range(1, 64) if arity**n >= nb)
    shares = shares_of_pairs(nb, [min(arity**n, nb) for n in range(1, height + 1)])
    return sum(2 * level * share for level, share in enumerate(shares, 1))
