"""Machines compared in seconds: the same work on each, by its fastest dataflow.

Profits compare policies on one machine and say nothing across machines. Here the *time* of a
machine with some nodes is the makespan of the dataflow that is the fastest there, and its
*node-seconds* are PEs x makespan: what it costs where nodes are alike. They seldom are, so where
machines state the power of a PE or its price, energy and price are told as well.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from statistics import geometric_mean
from typing import Any

from simmpp.run import words
from simmpp.run.machines import machine_of
from simmpp.sweeps.winners.contest import contests_of
from simmpp.sweeps.winners.points import Points

PROCESSORS, POINT = "processors", "point"
NAMING = ("machine.preset", "machine.file", "preset", "file", POINT)
"""Keys whose value alone names a machine."""
PS_PER_HOUR = 3600 * 10**12
Numbers = Mapping[str, Any]


@dataclass(frozen=True)
class Offer:
    """What one machine with some nodes takes for the work."""

    machine: str
    processors: int
    point: int
    """Number of the fastest dataflow there."""
    makespan_ps: float
    """Geometric mean of its seeds."""
    joules: float | None = None
    """None where the machine does not state its power; so the price."""
    price: float | None = None

    @property
    def node_ps(self) -> float:
        """PEs x makespan."""
        return self.processors * self.makespan_ps


@dataclass(frozen=True)
class Race:
    """All machines that did one work."""

    of: str
    """The work, in words; nothing if there is one only."""
    offers: tuple[Offer, ...]
    """By machine, and then by nodes."""

    @property
    def machines(self) -> list[str]:
        """In the order of the sweep."""
        return list(dict.fromkeys(offer.machine for offer in self.offers))


@dataclass(frozen=True)
class Machines:
    """The races of a sweep."""

    points: Points
    races: list[Race] = field(default_factory=list)
    """Those of two machines or more."""


def machines_of(points: Points, record: Numbers) -> Machines:
    """Compare the machines of a sweep; its ``record`` tells what they are."""
    axes = _axes_of_machines(points, record)
    apart = [name for name in points.axes if name not in (*axes, PROCESSORS)]
    offers: dict[str, list[Offer]] = {}
    for contest in contests_of(points) if axes else ():
        of = words.point({name: points.at(contest.best, name) for name in apart}, apart)
        offers.setdefault(of, []).append(_offer(points, contest.best, axes, record))
    races = [Race(of, tuple(there)) for of, there in offers.items()]
    return Machines(points, [race for race in races if len(race.machines) > 1])


def _axes_of_machines(points: Points, record: Numbers) -> list[str]:
    """Axes that change the machine and nothing else but its number of nodes."""
    return [
        name
        for name in points.axes
        if name.split(".")[0] == "machine" or (name == POINT and _are_machines(record))
    ]


def _are_machines(record: Numbers) -> bool:
    """Whether the named points of a sweep set nothing but machines and their nodes."""
    config = record.get("config")
    sweep = config.get("sweep") if isinstance(config, dict) else None
    named = sweep.get("points") if isinstance(sweep, dict) else None
    if not isinstance(named, list) or not all(isinstance(of, dict) for of in named):
        return False
    keys = {key.split(".")[0] for of in named for key in of}
    return "machine" in keys and keys <= {"name", "machine", PROCESSORS}


def _offer(points: Points, number: int, axes: Sequence[str], record: Numbers) -> Offer:
    row = points.profits[number]
    nb = row[PROCESSORS]
    makespan_ps = geometric_mean(max(run["makespan_ps"], 1) for run in points.runs[number])
    name = ", ".join(filter(None, (_named(axis, row[axis]) for axis in axes)))
    constants = machine_of(record, row) or {}
    hours = nb * makespan_ps / PS_PER_HOUR
    joules = _stated(constants, "power_mw", hours * 3600 / 1000)
    return Offer(
        name, nb, number, makespan_ps, joules, _stated(constants, "price_micros", hours / 10**6)
    )


def _stated(constants: Numbers, name: str, factor: float) -> float | None:
    number = constants.get(name)
    return number * factor if isinstance(number, int) and number > 0 else None


def _named(key: str, cell: object) -> str:
    """``"gpu-node"``, ``"latency 1 us"``; a mapping as rows have it, by what is in it."""
    if cell == "":
        return ""
    if isinstance(cell, str) and cell.startswith("{"):
        of = json.loads(cell)
        return ", ".join(_named(name, value) for name, value in of.items())
    if key in NAMING:
        return str(cell)
    name = key.removeprefix("machine.")
    text = json.dumps(cell) if isinstance(cell, dict | list) else words.value(key, cell)
    return f"{name} {text}"
