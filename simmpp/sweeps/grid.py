"""The points that a configuration asks for: every combination of its axes, policies and seeds."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from math import prod

from simmpp.errors import ConfigError
from simmpp.policy.parameters import PolicyParameters
from simmpp.sweeps.axes import axes_of
from simmpp.sweeps.config import Config, described, point_at
from simmpp.sweeps.point import REFERENCE
from simmpp.units import counted

MOST_POINTS = 1_000_000
"""Combinations of values and seeds of one sweep: a day's work at ten a second."""
OWN_COLUMNS = ("scene", "processors", "memory.fraction", "policy", "method")
"""Keys that have a column in every table of rows, swept or not."""

Value = int | float | str
"""What a cell of a table holds."""


@dataclass(frozen=True, eq=False)
class GridPoint:
    """One policy at one combination of the axes, with one seed."""

    config: Config
    policy: PolicyParameters
    seed: int
    swept: Mapping[str, Value]
    """Value of each further column."""


@dataclass(frozen=True, eq=False)
class _Setting:
    """What the policies of one comparison share."""

    config: Config
    swept: Mapping[str, Value]
    policies: dict[str, PolicyParameters]
    """By title."""


def further_columns(config: Config) -> tuple[str, ...]:
    """Columns of rows for the keys that only this sweep changes, in the order of its axes."""
    axes = axes_of(config.settings.sweep).values()
    names = (name for axis in axes for choice in axis for name in choice.columns)
    return tuple(name for name in dict.fromkeys(names) if name not in OWN_COLUMNS)


def grid(config: Config) -> list[GridPoint]:
    """All points, policies with object dataflow as their reference, in the order of the axes.

    Raises ConfigError for values that do not go together, and for policies that are not equal but
    would have equal rows, or for more than MOST_POINTS.
    """
    _require_feasible(config)
    return [
        GridPoint(setting.config, policy, seed, setting.swept)
        for setting in _settings(config)
        for seed in config.settings.seeds
        for policy in _with_reference(setting.policies)
    ]


def _require_feasible(config: Config) -> None:
    """Count before anything is made of it: four axes of a thousand values are easily written."""
    n_combinations = prod(map(len, axes_of(config.settings.sweep).values()))
    n_seeds = len(config.settings.seeds)
    if n_combinations * n_seeds > MOST_POINTS:
        raise ConfigError(
            f"sweep: {n_combinations} combinations with {counted(n_seeds, 'seed')} each: "
            f"expected at most {MOST_POINTS} points"
        )


def _settings(config: Config) -> list[_Setting]:
    """Combinations of the axes; those that differ in their policies only are one."""
    found: dict[str, _Setting] = {}
    for point, swept in _combinations(config):
        key = json.dumps([described(point) | {"policy": None}, swept], sort_keys=True)
        setting = found.setdefault(key, _Setting(point, swept, {}))
        for policy in point.policies:
            if setting.policies.setdefault(policy.title, policy) != policy:
                raise ConfigError(
                    f"sweep: two policies are called {policy.title!r}: expected a label for each"
                )
    return list(found.values())


def _combinations(config: Config) -> Iterator[tuple[Config, Mapping[str, Value]]]:
    axes = axes_of(config.settings.sweep)
    columns = further_columns(config)
    for numbers in product(*(range(len(axis)) for axis in axes.values())):
        chosen = dict(zip(axes, numbers, strict=True))
        names = {k: v for name, n in chosen.items() for k, v in axes[name][n].columns.items()}
        yield point_at(config, axes, chosen), {name: _cell(names[name]) for name in columns}


def _cell(value: object) -> Value:
    """A swept value as it is written in rows."""
    if isinstance(value, int | float | str) and not isinstance(value, bool):
        return value
    return json.dumps(value, default=str)


def _with_reference(policies: Mapping[str, PolicyParameters]) -> list[PolicyParameters]:
    """What profits are measured against comes first, named or not."""
    reference = policies.get(REFERENCE, PolicyParameters(REFERENCE))
    return [reference, *(policy for title, policy in policies.items() if title != REFERENCE)]
