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

    send_startup_ps: int
    receive_startup_ps: int
    latency_ps: int
    bytes_per_s: int
    """That of the mean time of a byte; 0: unlimited."""


def mean_flight(constants: Mapping[str, Any]) -> Flight:
    """Of a machine's fields, as ``run.json`` has them; KeyError where these were others."""
    nb, levels = prod(constants["shape"]), constants.get("levels")
    if levels:
        return _of_levels(constants, levels, nb)
    rates = [constants["link_bytes_per_s"], constants["injection_bytes_per_s"]]
    if constants.get("topology") == FAT_TREE:
        hops = _hops_in_tree(nb, constants["fat_tree"]["arity"])
    else:
        hops = _hops_in_torus(constants["shape"])
    latency_ps = constants["latency_ps"] + round(hops * constants["hop_latency_ps"])
    send_ps, receive_ps = (constants[name] for name in STARTUPS)
    return Flight(send_ps, receive_ps, latency_ps, min(filter(None, rates), default=0))


def _of_levels(
    constants: Mapping[str, Any], levels: Sequence[Mapping[str, Any]], nb: int
) -> Flight:
    blocks = list(accumulate((level["size"] for level in levels[:-1]), int.__mul__))
    shares = shares_of_pairs(nb, [*blocks, nb])
    means = dict.fromkeys((*STARTUPS, "latency_ps", "s_per_byte"), 0.0)
    for share, level in zip(shares, levels, strict=True):
        rate = level["bytes_per_s"]
        means["latency_ps"] += share * level["latency_ps"]
        means["s_per_byte"] += share / rate if rate else 0.0
        for name in STARTUPS:
            means[name] += share * level.get(name, constants[name])
    send_ps, receive_ps = (round(means[name]) for name in STARTUPS)
    rate = round(1 / means["s_per_byte"]) if means["s_per_byte"] else 0
    return Flight(send_ps, receive_ps, round(means["latency_ps"]), rate)


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
