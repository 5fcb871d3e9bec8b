"""How far constants may be off: the range of each as data, for whoever asks what depends on them.

A range is an estimate's, what several sources say, or a confidence interval: the source says which.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from simmpp.common.places import KeyPath, Place, misplaced
from simmpp.common.sourced import Cited
from simmpp.common.strict import structure
from simmpp.common.units import UNLIMITED
from simmpp.machine.constants import Constants

Ranges = Mapping[str, tuple[int, int]]
"""Least and greatest value of constants, by the keys of ``Constants.flat``."""
NO_RANGES: Ranges = MappingProxyType({})


class Known(NamedTuple):
    """What is known of one constant."""

    value: int
    """As a machine has it: ps, bytes, bytes per second, or a number."""
    low: int
    """Least value that it may have; its value where no range is stated."""
    high: int
    """The greatest, which for a bandwidth may be UNLIMITED."""
    source: str

    @property
    def is_exact(self) -> bool:
        """No range is stated."""
        return self.low == self.high


def known_of(
    numbers: Mapping[str, int], sources: Mapping[str, str], ranges: Ranges
) -> dict[str, Known]:
    """All that is known of constants, by the key of each."""
    return {
        key: Known(number, *ranges.get(key, (number, number)), sources[key])
        for key, number in numbers.items()
    }


def written(key: str, cited: Collection[str]) -> str:
    """A file's key of a constant: ``pack.fixed`` there says what ``pack.rays.fixed`` is."""
    first, _, last = key.partition(".")
    candidates = (key, f"{first}.{last.rpartition('.')[2]}", first)
    return next(candidate for candidate in candidates if candidate in cited)


def ranges_of(
    values: Mapping[str, Any], cited: Cited, places: Mapping[KeyPath, Place]
) -> dict[str, tuple[int, int]]:
    """The ranges that a file states beside the ``values`` of its constants.

    Raises ConfigError, with its place, for an end that can't be, or a value beyond them.
    """
    if not cited.ranges:
        return {}
    at_range = {path: places.get((*path, "range"), place) for path, place in places.items()}
    lows, highs = ({key: ends[n] for key, ends in cited.ranges.items()} for n in (0, 1))
    low, value, high = (
        structure(Constants, _with(values, ends), at_range).flat() for ends in (lows, {}, highs)
    )
    for key in value:
        ordered = [_size(key, of[key]) for of in (low, value, high)]
        if ordered != sorted(ordered):
            said = written(key, cited.texts)
            problem = f"value {cited.texts[said]}: expected in its range, {spans_of(cited)[said]}"
            raise misplaced(tuple(said.split(".")), problem, at_range)
    return {key: (low[key], high[key]) for key in value if low[key] != high[key]}


def spans_of(cited: Cited) -> dict[str, str]:
    """Ranges as a file has them."""
    return {key: f"{low} to {high}" for key, (low, high) in cited.ranges.items()}


def _with(values: Mapping[str, Any], ends: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """The values, and of those that have one this end of the range in place of each."""
    return {
        name: _with(value, ends, f"{prefix}{name}.")
        if isinstance(value, dict)
        else ends.get(prefix + name, value)
        for name, value in values.items()
    }


def _size(key: str, number: int) -> float:
    """For comparing: no bandwidth is above one without limit."""
    return math.inf if number == UNLIMITED and key.endswith("bandwidth") else number
