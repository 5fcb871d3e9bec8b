"""Constants over constants: a preset, the costs of a reading, what a user sets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from simmpp.common.errors import ConfigError
from simmpp.common.strict import in_words
from simmpp.machine.constants import Constants
from simmpp.machine.machine import FAT_TREE, LEVELS, POLLED, TORUS, Level
from simmpp.machine.ranges import NO_RANGES, Known, Ranges, known_of
from simmpp.machine.transfer import slower

BELONGS = {
    "shape": (TORUS,),
    "hop_latency": (TORUS, FAT_TREE),
    "levels": (LEVELS,),
    "fat_tree": (FAT_TREE,),
}
"""Keys that mean something with these topologies only."""
_TRIANGLES = ("test.log2", "test.per_triangle")
"""Costs of triangles, of which one is 0."""


@dataclass
class Layers:
    """What the layers so far say together; the later ones come before the earlier ones."""

    numbers: dict[str, int] = field(default_factory=dict)
    """As ``Constants.flat`` has them."""
    sources: dict[str, str] = field(default_factory=dict)
    """By the same keys."""
    words: dict[str, str] = field(default_factory=lambda: {"topology": TORUS, "service": POLLED})
    """The choices."""
    unlike: dict[str, Any] = field(default_factory=dict)
    """``speed``, ``noise``, ``straggler``: each as the last layer that speaks of it says."""
    ranges: dict[str, tuple[int, int]] = field(default_factory=dict)
    """Of those that may be off, by the same keys."""
    level_names: tuple[str, ...] = ()
    """The innermost first."""

    @property
    def known(self) -> dict[str, Known]:
        """Value, range and source of each constant."""
        return known_of(self.numbers, self.sources, self.ranges)

    def put(
        self, constants: Constants, source_of: Callable[[str], str], ranges: Ranges = NO_RANGES
    ) -> None:
        """A further layer. Levels of names that are known change these, others replace all."""
        self.words |= {"topology": implied(constants) or self.words["topology"]}
        self.words |= constants.words()
        self.unlike |= (unlike := constants.unlike())
        names = tuple(constants.levels or ())
        if not set(names) <= set(self.level_names):
            self.level_names = names
            for key in [key for key in self.numbers if key.startswith("levels.")]:
                del self.numbers[key], self.sources[key]
                self.ranges.pop(key, None)
        given = constants.flat()
        cited = {key: source_of(key) for key in given}
        for key, other in (_TRIANGLES, _TRIANGLES[::-1]):
            if given.get(key) and not given.get(other):
                given[other], cited[other] = 0, cited[key]
        self.numbers |= given
        self.sources |= cited | {key: source_of(key) for key in unlike}
        of_others = {key: ends for key, ends in self.ranges.items() if key not in given}
        self.ranges = of_others | dict(ranges)

    def refuse_strangers(self, constants: Constants) -> None:
        """Raise ConfigError, with the key, for what a layer sets in vain."""
        if all(constants.flat().get(key) for key in _TRIANGLES):
            problem = f"it replaces {_TRIANGLES[1]}: expected one of them"
            raise ConfigError(problem, where=_TRIANGLES[0])
        topology = self.words["topology"]
        for key, topologies in BELONGS.items():
            if getattr(constants, key) is not None and topology not in topologies:
                known = in_words(topologies)
                problem = f"it goes with topology {known}, and this machine's is {topology}"
                raise ConfigError(problem, where=key)

    def levels(self) -> tuple[Level, ...]:
        """The levels; what they do not say the machine does."""
        of_machine = {
            "latency": self.numbers["latency"],
            "bandwidth": slower(
                self.numbers["link_bandwidth"], self.numbers["injection_bandwidth"]
            ),
            "gap": self.numbers["port_gap"],
            "send_startup": self.numbers["send_startup"],
            "receive_startup": self.numbers["receive_startup"],
        }
        return tuple(self._level(name, of_machine) for name in self.level_names)

    def _level(self, name: str, of_machine: dict[str, int]) -> Level:
        prefix = f"levels.{name}."
        own = {k.removeprefix(prefix): n for k, n in self.numbers.items() if k.startswith(prefix)}
        said = of_machine | own
        return Level(
            name,
            size=said.get("size", 0),
            latency_ps=said["latency"],
            bytes_per_s=said["bandwidth"],
            gap_ps=said["gap"],
            ports=said.get("ports", 1),
            send_startup_ps=said["send_startup"],
            receive_startup_ps=said["receive_startup"],
        )


def implied(constants: Constants) -> str | None:
    """The topology that constants speak of without its name."""
    return LEVELS if constants.levels else FAT_TREE if constants.fat_tree else None
