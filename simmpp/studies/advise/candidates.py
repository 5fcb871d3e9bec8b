"""Candidates of a question: each setup on each number of nodes, with its memory."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from simmpp.common.errors import ConfigError
from simmpp.common.places import misplaced, unknown
from simmpp.common.units import shown, write_bytes
from simmpp.config.advice import AdviseSettings
from simmpp.config.config import Config, changed
from simmpp.engine.capacity import Needs, lacking, needs_of
from simmpp.machine.machine import POLLED, Machine
from simmpp.placement.place import place
from simmpp.placement.placement import Memory
from simmpp.placement.rooms import Capacity
from simmpp.policy.parameters import PolicyParameters
from simmpp.studies.advise.constants import Constant, with_constants
from simmpp.studies.advise.setups import BY_NAME, MOST_CANDIDATES, SETUPS, Setup, rank
from simmpp.sweeps.grid import Comparison, GridPoint
from simmpp.sweeps.task import Task, task_of
from simmpp.workload.workload import Workload

MOST_HALVINGS = 5
"""Of a budget of nodes: all, and five halvings of it. ESTIMATE: below a 32nd others are asked."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """One setup on one number of nodes."""

    setup: Setup
    processors: int
    config: Config
    """With all its keys set."""
    keys: Mapping[str, Any]
    """Those keys, as a configuration has them."""
    digest: str
    """Of the workload."""
    least_bytes: int
    """The least memory of a node with which it runs."""
    lacking_bytes: int
    """By how much a node's is too small; 0: it fits."""

    @property
    def name(self) -> str:
        """How rows call it."""
        return f"{self.setup.name} on {self.processors}"

    @property
    def order(self) -> tuple[int, int, str]:
        """The fewest nodes first, then the simplest."""
        return self.processors, rank(self.setup), self.setup.name

    @property
    def fits(self) -> bool:
        """By the static sum."""
        return self.lacking_bytes == 0

    @property
    def policy(self) -> PolicyParameters:
        """The dataflow policy."""
        return self.config.settings.policy[0]

    @cached_property
    def machine(self) -> Machine:
        """With its number of nodes."""
        return self.config.machine_for(self.processors)

    def task(self, seed: int) -> Task:
        """Its simulation with the draws of a seed."""
        return task_of(_point(self.config, seed), self.digest)

    def changed_task(self, values: Mapping[Constant, int]) -> Task | None:
        """Its simulation on a machine with other constants, with the first seed.

        None where there is no such machine.
        """
        try:
            return task_of(_point(with_constants(self.config, values), 0), self.digest)
        except ConfigError:
            return None

    @property
    def has_credits(self) -> bool:
        """Rays are sent only where there is room for them."""
        bounds = self.config.memory.bounds
        return bounds is not None and bounds.has_credits

    def task_without_credits(self) -> Task:
        """Its simulation with queues without end, which are only compared with the capacity."""
        path = ("memory", "flow")
        return task_of(
            _point(changed(self.config, [("memory.flow", "none", path)]), 0), self.digest
        )

    @property
    def kind(self) -> tuple[str, int]:
        """Candidates of one kind behave alike."""
        return self.policy.name, self.processors

    @cached_property
    def is_drawn(self) -> bool:
        """Chance has a part in it: seeds are different simulations."""
        return self.task(1).seed == 1


def _point(config: Config, seed: int) -> GridPoint:
    policy = config.settings.policy[0]
    return GridPoint(Comparison(config, {}, {policy.title: policy}), policy, seed)


def candidates_of(config: Config, workload: Workload) -> list[Candidate]:
    """All candidates of a configuration's question, equal ones once, by nodes and then simplicity.

    Raises InputError for what can't be asked.
    """
    capacity_of(config)
    found: dict[str, Candidate] = {}
    for size in sizes_of(config):
        for candidate in candidates_on(config, workload, size):
            found.setdefault(candidate.task(0).key, candidate)
    return sorted(found.values(), key=lambda each: each.order)


def candidates_on(config: Config, workload: Workload, size: int) -> list[Candidate]:
    """Those on one number of nodes."""
    asked = config.settings.advise or AdviseSettings()
    setups = setups_of(config, asked, len(sizes_of(config)))
    setups.sort(key=lambda each: (rank(each), each.name))  # of equal ones the first is kept
    capacity = capacity_of(config)
    made = (_candidate(config, workload, setup, size, capacity) for setup in setups)
    return [candidate for candidate in made if candidate is not None]


def capacity_of(config: Config) -> int:
    """Bytes of a node.

    Raises ConfigError if the configuration does not say them.
    """
    capacity = config.memory.capacity
    if not isinstance(capacity, int):
        given = shown(capacity or "none")
        problem = f"value {given}: expected the memory of a node, such as '64 MB'"
        raise misplaced(("memory", "capacity"), problem, config.places)
    return capacity


def sizes_of(config: Config) -> list[int]:
    """Numbers of nodes to choose from, rising."""
    asked = config.settings.advise or AdviseSettings()
    if asked.budget is not None:
        halves = (asked.budget >> n for n in range(MOST_HALVINGS + 1))
        return sorted({size for size in halves if size})
    return sorted(asked.processors or (config.processors,))


def setups_of(config: Config, asked: AdviseSettings, n_sizes: int) -> list[Setup]:
    """What to try on each number of nodes: those asked for, or as many as the question may have."""
    most = max(1, MOST_CANDIDATES // n_sizes)
    if asked.candidates is None:
        return list(SETUPS[:most])
    path = ("advise", "candidates")
    setups = [_own(entry, config) for entry in asked.candidates]
    names = [setup.name for setup in setups]
    if twice := next((name for name in names if names.count(name) > 1), None):
        problem = f"two are called {shown(twice)}: expected different names"
        raise misplaced(path, problem, config.places)
    if len(setups) > most:
        problem = f"{len(setups)} on {n_sizes} numbers of nodes: expected at most {most}"
        raise misplaced(path, f"{problem} ({MOST_CANDIDATES} together)", config.places)
    return setups


def _own(entry: str | dict[str, Any], config: Config) -> Setup:
    """A setup by its name, or one's own."""
    path = ("advise", "candidates")
    if isinstance(entry, str):
        if entry not in BY_NAME:
            raise misplaced(path, unknown(entry, list(BY_NAME)), config.places)
        return BY_NAME[entry]
    keys = {key: value for key, value in entry.items() if key != "name"}
    if "processors" in keys or not keys:
        problem = f"value {shown(entry)}: expected keys such as policy, and no processors"
        raise misplaced(path, problem, config.places)
    says = any(key in ("memory", "memory.bytes", "memory.fraction") for key in keys)
    return Setup(str(entry["name"]), keys, None if says else Fraction(1, 2))


def _candidate(
    config: Config, workload: Workload, setup: Setup, size: int, capacity: int
) -> Candidate | None:
    """One candidate; None where the number of nodes can't be dealt so."""
    keys = {"processors": size, **setup.keys}
    islands = keys.get("placement.islands", config.settings.placement.islands)
    if size % islands or islands == size > 1:  # the latter is the replicated scene
        return None
    made = _with(config, keys)
    if len(made.settings.policy) > 1 and "policy" not in keys:
        raise ConfigError(f"candidate {setup.name!r}: expected a key policy")
    machine = made.machine_for(size)
    own = replace(Memory(bytes=0), residents="random", transient=0)
    bounds = Capacity(capacity, made.memory.flow, made.memory.escape)
    placement = place(workload, size, own, made.settings.placement, seed=0)
    placement = replace(placement, capacity=bounds)
    needs = needs_of(workload, machine, placement, made.settings.policy[0])
    scene_bytes = int(workload.object_bytes.sum())
    lacks = lacking(needs, placement, scene_bytes)
    keys |= _residents(setup, needs, capacity, scene_bytes, lacks)
    if machine.service != POLLED:
        keys["memory.capacity"] = "none"  # the engine's ends where PEs answer requests alone
    made = _with(config, keys)
    return Candidate(setup, size, made, keys, workload.digest, needs.least_bytes, lacks)


def _with(config: Config, keys: Mapping[str, Any]) -> Config:
    path = ("advise", "candidates")
    return changed(config, [(key, value, path) for key, value in keys.items()])


def _residents(
    setup: Setup, needs: Needs, capacity: int, scene_bytes: int, lacks: int
) -> dict[str, Any]:
    """The key that says how much of a node's memory is for resident objects."""
    if setup.room is None or lacks:
        return {}
    free = max(0, capacity - needs.least_bytes)
    room = int(needs.resident.max()) + int(setup.room * free)
    if room >= scene_bytes:
        return {"memory.fraction": 1}
    return {"memory.bytes": write_bytes(room)}
