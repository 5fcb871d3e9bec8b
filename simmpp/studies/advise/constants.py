"""The constants of a machine that may be off, each with its range, and machines within the ranges.

Constants of several kinds of messages or primitives that have one range are one constant.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from simmpp.common.randomness import key
from simmpp.common.units import UNLIMITED
from simmpp.config.config import Config, changed
from simmpp.config.keys import NAME, Key, keys
from simmpp.machine.layers import BELONGS
from simmpp.machine.machine import NIC, THREAD

_IDLE = {"handoff": THREAD, "get_startup": NIC, "completion": NIC}
"""Constants that only this way of answering requests spends."""
_NO_TIME = ("power", "price", "fat_tree.arity")
"""Constants that change no run, or which machine can be built."""


@dataclass(frozen=True)
class Constant:
    """One that may be off."""

    name: str
    """As a configuration has it below ``machine``: pack.fixed, test."""
    keys: tuple[str, ...]
    """As ``Constants.flat`` has them."""
    value: int
    low: int
    high: int

    @property
    def is_rate(self) -> bool:
        """A bandwidth, where 0 is without limit."""
        return self.name.endswith("bandwidth")

    def at(self, share: float) -> int:
        """The value so far from low (0) to high (1): by ratios, or evenly where one end is 0."""
        if self.is_rate and UNLIMITED in (self.low, self.high):
            slowest, fastest = 1 / (self.low or self.high), 0.0
            per_byte = slowest + share * (fastest - slowest)
            return round(1 / per_byte) if per_byte > 0 else UNLIMITED
        if self.low > 0:
            return round(self.low * (self.high / self.low) ** share)
        return round(self.low + share * (self.high - self.low))

    def text(self, value: int) -> str:
        """A value with its unit."""
        return _written(_key(self.keys[0]), value)

    def settings(self, value: int) -> dict[str, object]:
        """The keys of a configuration that give it a value."""
        return {f"machine.{name}": _as_yaml(self.text(value)) for name in self.keys}


def constants_of(config: Config) -> list[Constant]:
    """Those of the configuration's machine that have a range and part in its runs."""
    layers = config.layers
    alike: dict[tuple[str, int, int, int], list[str]] = {}
    for name, known in layers.known.items():
        if not (known.is_exact or name in _NO_TIME or _is_idle(name, layers.words)):
            place = (_family(name), known.value, known.low, known.high)
            alike.setdefault(place, []).append(name)
    found = []
    families = [place[0] for place in alike]
    for (family, value, low, high), names in alike.items():
        name = family if families.count(family) == 1 else names[0]
        found.append(Constant(name, tuple(names), value, low, high))
    return found


def _is_idle(name: str, words: Mapping[str, str]) -> bool:
    """Nothing is spent on it with the machine's service and topology."""
    topologies = BELONGS.get(name.partition(".")[0], (words["topology"],))
    services = (_IDLE.get(name, words["service"]),)
    return words["topology"] not in topologies or words["service"] not in services


def _family(name: str) -> str:
    """``pack.rays.fixed`` is one of ``pack.fixed``, ``test.sphere`` of ``test``."""
    first, _, last = name.partition(".")
    if first in ("pack", "unpack"):
        return f"{first}.{last.rpartition('.')[2]}"
    return "test" if first == "test" else name


def _key(name: str) -> Key:
    """What a configuration says about a constant."""
    known = keys()
    if (plain := f"machine.{name}") in known:
        return known[plain]
    first, _, last = name.split(".")
    return known[f"machine.{first}.{NAME}.{last}"]


def _written(key: Key, value: int) -> str:
    return key.expect.write(value)


def _as_yaml(text: str) -> object:
    return int(text) if text.isdigit() else text


def with_constants(config: Config, values: Mapping[Constant, int]) -> Config:
    """The configuration with other values of constants.

    Raises ConfigError where they do not go together.
    """
    settings: dict[str, Any] = {}
    for constant, value in values.items():
        settings |= constant.settings(value)
    return changed(config, [(name, value, ("machine",)) for name, value in settings.items()])


def drawn(constants: Iterable[Constant], n_draws: int, stream: str) -> list[dict[Constant, int]]:
    """A Latin hypercube: every constant has one value in each n-th of its range.

    Source: McKay, Beckman and Conover 1979, Technometrics 21(2).
    """
    draws = np.random.Generator(np.random.Philox(key(n_draws, stream)))
    found: list[dict[Constant, int]] = [{} for _ in range(n_draws)]
    for constant in constants:
        shares = (draws.permutation(n_draws) + draws.random(n_draws)) / n_draws
        for machine, share in zip(found, shares.tolist(), strict=True):
            machine[constant] = constant.at(share)
    return found


def log_ratio(upper: float, lower: float) -> float:
    """Of two costs, of which either may be infinite."""
    if math.isinf(upper) or math.isinf(lower):
        return 0.0 if upper == lower else math.copysign(math.inf, upper - lower)
    return math.log(upper / lower)
