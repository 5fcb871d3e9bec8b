"""The lines of a sweep that can be refined: comparisons that differ in one number only."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction

from simmpp.strict import misplaced
from simmpp.sweeps.axes import Axis, axes_of
from simmpp.sweeps.config import Config, changed, described
from simmpp.sweeps.grid import Comparison
from simmpp.sweeps.refining import FEWEST

FRACTION = "memory.fraction"
UNREFINED = ("scene", "picture", "policy", "method")
"""Keys with other rays or other policies at each value: there is nothing in between."""


def refined_keys(config: Config) -> list[str]:
    """The keys of the axes that are refined.

    Raises ConfigError if that is asked for and there is none.
    """
    if not config.settings.refine:
        return []
    axes = axes_of(config.settings.sweep)
    keys = [name for name, axis in axes.items() if _is_refinable(name, axis)]
    if not keys:
        problem = f"expected an axis of at least {FEWEST} numbers under sweep, such as {FRACTION}"
        raise misplaced(("refine",), problem, config.source.places if config.source else {})
    return keys


def _is_refinable(name: str, axis: Axis) -> bool:
    values = [choice.assignments.get(name) for choice in axis]
    are_whole = all(isinstance(value, int) and not isinstance(value, bool) for value in values)
    if len(set(map(str, values))) < FEWEST or name.split(".")[0] in UNREFINED:
        return False
    return name == FRACTION or are_whole


def value_of(comparison: Comparison, key: str) -> Fraction:
    """Where a comparison is on an axis."""
    if key == FRACTION:
        return Fraction(comparison.config.memory.fraction)
    return Fraction(comparison.config.processors if key == "processors" else comparison.swept[key])


def moved(comparison: Comparison, key: str, value: Fraction) -> Comparison:
    """The same comparison at another value of an axis."""
    assigned = value if key == FRACTION else int(value)
    config = changed(comparison.config, [(key, assigned, ("sweep", key))])
    swept = dict(comparison.swept)
    if key in swept:
        swept[key] = int(value)
    return replace(comparison, config=config, swept=swept)


def identity(comparison: Comparison, but: str | None = None) -> str:
    """Equal for comparisons that are equal, or that differ in the key ``but`` only."""
    config = described(comparison.config) | {"policy": None}
    swept = {key: value for key, value in comparison.swept.items() if key != but}
    if but is not None:
        *path, last = but.split(".")
        node = config
        for part in path:
            node = node[part]
        node.pop(last, None)
    return json.dumps([config, swept], sort_keys=True)
