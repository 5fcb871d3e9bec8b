"""The points that a configuration asks for: every combination of its axes, policies and seeds."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from math import prod

from simmpp.common.errors import ConfigError
from simmpp.common.units import counted
from simmpp.config.config import Config, described, point_at
from simmpp.policy.parameters import REFERENCE, PolicyParameters
from simmpp.sweeps.stopping import first_seeds

MOST_POINTS = 1_000_000
"""Combinations of values and seeds of one sweep: a day's work at ten a second."""
OWN_COLUMNS = ("scene", "processors", "memory.fraction", "policy", "method")
"""Keys that have a column in every table of rows, swept or not."""

Value = int | float | str
"""What a cell of a table holds."""


@dataclass(frozen=True, eq=False)
class Comparison:
    """Policies at one combination of the axes; all of them are run with the same seeds."""

    config: Config
    swept: Mapping[str, Value]
    """Value of each further column."""
    policies: dict[str, PolicyParameters]
    """By title, without the reference unless it is named."""

    @property
    def with_reference(self) -> list[PolicyParameters]:
        """What profits are measured against comes first, named or not."""
        reference = self.policies.get(REFERENCE, self.config.reading.policy(REFERENCE))
        return [reference, *(p for title, p in self.policies.items() if title != REFERENCE)]

    def points(self, seeds: Iterable[int]) -> list[GridPoint]:
        """Every policy with each of these seeds."""
        return [GridPoint(self, policy, seed) for seed in seeds for policy in self.with_reference]


@dataclass(frozen=True, eq=False)
class GridPoint:
    """One policy at one combination of the axes, with one seed."""

    comparison: Comparison
    policy: PolicyParameters
    seed: int

    @property
    def config(self) -> Config:
        """The configuration of that combination."""
        return self.comparison.config

    @property
    def swept(self) -> Mapping[str, Value]:
        """Value of each further column."""
        return self.comparison.swept


def further_columns(config: Config) -> tuple[str, ...]:
    """Columns of rows for the keys that only this sweep changes, in the order of its axes."""
    names = (name for axis in config.axes.values() for choice in axis for name in choice.columns)
    return tuple(name for name in dict.fromkeys(names) if name not in OWN_COLUMNS)


def grid(config: Config) -> list[GridPoint]:
    """All points, policies with object dataflow as their reference, in the order of the axes.

    With a tolerance these are the points that a sweep begins with.
    Raises ConfigError for values that do not go together, and for policies that are not equal but
    would have equal rows, or for more than MOST_POINTS.
    """
    seeds = first_seeds(config.settings)
    _require_feasible(config, len(seeds))
    return [point for comparison in comparisons(config) for point in comparison.points(seeds)]


def _require_feasible(config: Config, n_seeds: int) -> None:
    """Count before anything is made of it: four axes of a thousand values are easily written."""
    n_combinations = prod(map(len, config.axes.values()))
    if n_combinations * n_seeds > MOST_POINTS:
        raise ConfigError(
            f"sweep: {n_combinations} combinations with {counted(n_seeds, 'seed')} each: "
            f"expected at most {MOST_POINTS} points"
        )


def comparisons(config: Config) -> list[Comparison]:
    """Combinations of the axes; those that differ in their policies only are one."""
    combinations: dict[str, Comparison] = {}
    for point, swept in _combinations(config):
        key = json.dumps([described(point) | {"policy": None}, swept], sort_keys=True)
        policies = combinations.setdefault(key, Comparison(point, swept, {})).policies
        for policy in point.settings.policy:
            if policies.setdefault(policy.title, policy) != policy:
                raise ConfigError(
                    f"sweep: two policies are called {policy.title!r}: expected a label for each"
                )
    return list(combinations.values())


def _combinations(config: Config) -> Iterator[tuple[Config, Mapping[str, Value]]]:
    axes = config.axes
    columns = further_columns(config)
    for numbers in product(*(range(len(axis)) for axis in axes.values())):
        choices = dict(zip(axes, numbers, strict=True))
        values = {k: v for name, n in choices.items() for k, v in axes[name][n].columns.items()}
        yield point_at(config, axes, choices), {name: cell(values[name]) for name in columns}


def cell(value: object) -> Value:
    """A swept value as it is written in rows."""
    if isinstance(value, int | float | str) and not isinstance(value, bool):
        return value
    return json.dumps(value, default=str)
