"""What an advisor knows to try on any number of nodes: policy, placement and memory together.

Placement decides more than the dataflow, so both are candidates. A further one is a line here: the
keys that it sets, as in ``sweep.points``, and how much of a node's memory its replicas get. The
simplest come first: of equals, the first is advised, and where numbers of nodes are many the last
ones are left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

MOST_CANDIDATES = 60
"""Of one question: more say little more, and each takes its runs."""


@dataclass(frozen=True)
class Setup:
    """One way to use a number of nodes."""

    name: str
    keys: Mapping[str, Any] = field(default_factory=dict)
    """Dotted keys over those of the configuration."""
    room: Fraction | None = Fraction(1, 2)
    """Of the memory that rays, buffers and own objects leave, what is for further residents; None:
    residents are as the configuration, or ``keys``, say."""


def _setup(
    name: str, room: Fraction | None, policy: object, pixels: object, **more: object
) -> Setup:
    keys = {"policy": policy, "placement.pixels": pixels, "memory.residents": "used"}
    given = {key.replace("__", "."): value for key, value in more.items()}
    return Setup(name, keys | given, room)


_QUARTER, _HALF, _MOST = (Fraction(n, 4) for n in (1, 2, 3))
_SQUARES = {"cells": 4}
_BY_USE = {"placement__owners": "used"}
_ANYWHERE = {"memory__residents": "random"}
_OBJECT = {"name": "object", "packing": "requests"}

SETUPS: tuple[Setup, ...] = (
    Setup("replicated", {"policy": "replicated", "placement.pixels": "interleaved"}, None),
    _setup("object", _HALF, _OBJECT, "interleaved"),
    _setup("ray", _HALF, "ray", "interleaved"),
    _setup("concurrent", _MOST, "concurrent", _SQUARES),
    _setup("object-near", _MOST, _OBJECT, _SQUARES, **_BY_USE),
    _setup("ray-islands", _HALF, "ray", "rows", placement__islands=4),
    _setup("holders-near", _MOST, "holders", _SQUARES, **_BY_USE),
    _setup("cost-near", _MOST, "cost", _SQUARES, **_BY_USE),
    _setup("object-blocks", _MOST, _OBJECT, "blocks", **_BY_USE),
    _setup("ray-blocks", _MOST, "ray", "blocks"),
    _setup("object-near-copies", _QUARTER, _OBJECT, _SQUARES, **_BY_USE),
    _setup("ray-halves", _HALF, "ray", "rows", placement__islands=2),
    _setup("object-blocks-hot", _MOST, _OBJECT, "blocks", memory__residents="hot"),
    _setup("object-squares", _MOST, _OBJECT, _SQUARES),
    _setup("concurrent-near-copies", _QUARTER, "concurrent", _SQUARES, **_BY_USE),
    _setup("holders-islands", _MOST, "holders", _SQUARES, placement__islands=4),
    _setup("cost-islands", _HALF, "cost", "rows", placement__islands=4),
    _setup("holders-halves", _HALF, "holders", "rows", placement__islands=2),
    _setup("ray-random", _HALF, "ray", "interleaved", **_ANYWHERE),
    _setup("concurrent-random", _HALF, "concurrent", "rows", **_ANYWHERE),
    _setup("object-steals", _MOST, _OBJECT | {"steal": "half"}, _SQUARES, **_BY_USE),
    _setup("ray-steals", _MOST, {"name": "ray", "steal": "half"}, "blocks"),
)
"""Found on four scenes and two machines, 280 tried: one of the first 20 is mostly within a
hundredth of the best. Names say how it is placed: near, pixels in squares and objects owned where
they are used; copies, most room is for what is fetched; islands and halves, the scene lies in four
or two parts of the machine each; random, residents are drawn; steals, idle nodes take rays of
others."""
BY_NAME = {setup.name: setup for setup in SETUPS}


def rank(setup: Setup) -> int:
    """Its place in the list, the simplest first; one's own come last."""
    return SETUPS.index(setup) if setup in SETUPS else len(SETUPS)
