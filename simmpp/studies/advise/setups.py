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


def _setup(name: str, policy: str | Mapping[str, Any], room: Fraction, **placed: Any) -> Setup:
    where = {
        "owners": "placement.owners",
        "pixels": "placement.pixels",
        "islands": "placement.islands",
        "residents": "memory.residents",
    }
    keys = {"memory.residents": "used"} | {where[key]: value for key, value in placed.items()}
    return Setup(name, {"policy": policy, **keys}, room)


_NOTHING, _QUARTER, _HALF, _MOST = (Fraction(n, 4) for n in range(4))
_ASKS_SOON = {"ask_at_least": 8}
_SMALL = {"batch": 64}

SETUPS: tuple[Setup, ...] = (
    Setup("replicated", {"policy": "replicated"}, None),
    _setup("object", {"name": "object", "packing": "requests"}, _HALF),
    _setup("ray", "ray", _HALF),
    _setup("concurrent", "concurrent", _HALF),
    _setup("holders", "holders", _HALF),
    _setup("cost", "cost", _HALF),
)
BY_NAME = {setup.name: setup for setup in SETUPS}


def rank(setup: Setup) -> int:
    """Its place in the list, the simplest first; one's own come last."""
    return SETUPS.index(setup) if setup in SETUPS else len(SETUPS)
