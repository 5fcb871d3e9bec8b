"""Axes of a sweep: keys that change, alone or together, and the values that they take."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from simmpp.common.errors import ConfigError
from simmpp.common.strict import is_line
from simmpp.common.units import shown

POINTS = "points"
"""The axis of named points; also the name of their column, less the plural."""
NAME = "name"
UNSWEPT = ("sweep", "seeds", "tolerance", "max_seeds", "refine", "engine", "check", "advise")
"""Keys that say how a sweep is made, and so can't be swept."""
MOST_VALUES = 1000
"""Values of one axis."""
SAME = {
    "memory.fraction": "memory.bytes",
    "memory.bytes": "memory.fraction",
}
"""Keys that say the same in another way: setting one takes the other back."""


def meet(one: str, other: str) -> bool:
    """Whether two keys are the same, or one is within the other: a value may be a mapping."""
    return f"{one}.".startswith(f"{other}.") or f"{other}.".startswith(f"{one}.")


@dataclass(frozen=True)
class Choice:
    """One value of an axis."""

    assignments: Mapping[str, object]
    """Value of each dotted key that it sets."""
    columns: Mapping[str, object]
    """What names it in rows: the same, or ``point`` and its name."""


Axis = tuple[Choice, ...]


def axes_of(sweep: Mapping[str, Sequence[object]]) -> dict[str, Axis]:
    """The axes of the key ``sweep``, by their names there.

    Raises ConfigError for one that isn't one, or that sets what another sets.
    """
    axes = {name: _axis(name, values) for name, values in sweep.items()}
    _refuse_twice(axes.values())
    return axes


def _refuse_twice(axes: Iterable[Axis]) -> None:
    """Raise ConfigError for what is set under two keys, such as memory and memory.fraction."""
    setting = [_keys_within(axis, key) for axis in axes for key in keys_of(axis)]
    for one, other in combinations(setting, 2):
        for key in one:
            if key in other:
                raise ConfigError(f"{key} is swept twice: expected one axis with it")
            if SAME.get(key) in other:
                both = " or ".join(pair for pair in SAME if pair in (key, SAME[key]))
                raise ConfigError(f"expected {both}, got both")


def keys_of(axis: Axis) -> list[str]:
    """Every key that an axis names, once."""
    return list(dict.fromkeys(key for choice in axis for key in choice.assignments))


def _keys_within(axis: Axis, key: str) -> dict[str, None]:
    """A key of an axis and those that its values hold, in their order."""
    values = [choice.assignments[key] for choice in axis if key in choice.assignments]
    return dict.fromkeys((key, *_dotted(key, values)))


def _dotted(key: str, value: object) -> Iterator[str]:
    if isinstance(value, Mapping):
        for name, child in value.items():
            yield f"{key}.{name}"
            yield from _dotted(f"{key}.{name}", child)
    elif isinstance(value, list | tuple):
        for child in value:
            yield from _dotted(key, child)


def _axis(name: object, values: object) -> Axis:
    label = name if isinstance(name, str) and name.isprintable() else repr(name)
    if not isinstance(values, list | tuple) or not 0 < len(values) <= MOST_VALUES:
        raise ConfigError(
            f"{label}: value {shown(values)}: expected a list of 1 to {MOST_VALUES} values"
        )
    if name == POINTS:
        return _named(values)
    keys = [_swept(key.strip()) for key in str(name).split(",")]
    if len(keys) == 1:
        return tuple(_choice(keys, [value]) for value in values)
    return tuple(_choice(keys, _row(label, keys, value)) for value in values)


def _swept(key: str) -> str:
    if key.split(".")[0] in UNSWEPT:
        raise ConfigError(f"{key!r} can't be swept")
    return key


def _choice(keys: Sequence[str], values: Sequence[object]) -> Choice:
    assignments = dict(zip(keys, values, strict=True))
    return Choice(assignments, assignments)


def _row(label: str, keys: Sequence[str], value: object) -> Sequence[object]:
    """The values of linked keys."""
    if not isinstance(value, list | tuple) or len(value) != len(keys):
        raise ConfigError(f"{label}: value {shown(value)}: expected a list of {len(keys)} values")
    return value


def _named(values: Sequence[object]) -> Axis:
    axis: list[Choice] = []
    for value in values:
        if not isinstance(value, dict) or not is_line(value.get(NAME)):
            raise ConfigError(
                f"{POINTS}: value {shown(value)}: expected a mapping with a name and the keys to "
                "set, such as {name: small, processors: 8}"
            )
        keys: dict[str, Any] = {_swept(key): value[key] for key in value if key != NAME}
        axis.append(Choice(keys, {POINTS[:-1]: value[NAME]}))
    names = [choice.columns[POINTS[:-1]] for choice in axis]
    for name in names:
        if names.count(name) > 1:
            raise ConfigError(f"{POINTS}: two are called {name!r}: expected different names")
    return tuple(axis)
