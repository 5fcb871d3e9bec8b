"""Where a sweep's axis is too coarse: a straight line between two points would be off.

What a line from a to b is off in the middle is estimated from the points beside it. Point i lies
beside the straight line through its neighbours by d(i), which is f''/2 h(i) h(i+1) for a curve of
second derivative f'' and steps h; a line over a step of h is off by f''/8 h^2 at most (the error
bound of linear interpolation, as in any text on numerical analysis). So an interval of length h is
off by |d(i)| h^2 / (4 h(i) h(i+1)), by the larger estimate of its two ends.

Noise bends curves too. d(i) is taken seed by seed (the points of a curve share their seeds, and
residents are nested, so much of the noise cancels), and counts only as far as it is beyond the
half-width of its own interval. Two points with the same values for every seed are one placement
twice, and nothing lies in between.

What is refined are lines of a sweep: comparisons that differ in one number only.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from statistics import fmean

from simmpp.common.places import misplaced
from simmpp.config.axes import Axis
from simmpp.config.config import Config, changed, described
from simmpp.placement.rooms import FILL
from simmpp.sweeps.grid import Comparison
from simmpp.sweeps.intervals import half_width
from simmpp.sweeps.stopping import CORRECTED

FEWEST_POINTS = 3
"""Points that can show a bend."""
MOST_HALVINGS = 4
"""How often an interval between two values that were given is divided: 15 points at most."""

FRACTION = "memory.fraction"
UNREFINED = ("scene", "picture", "policy", "method")
"""Keys with other rays or other policies at each value: there is nothing in between."""

Curve = Sequence[Sequence[float]]
"""For each abscissa, rising, the values of the seeds, in the seeds' order."""


def refined_keys(config: Config) -> list[str]:
    """The keys of the axes that are refined.

    Raises ConfigError if that is asked for and there is none.
    """
    if not config.settings.refine:
        return []
    keys = [name for name, axis in config.axes.items() if _is_refinable(name, axis)]
    if not keys:
        problem = (
            f"expected an axis of at least {FEWEST_POINTS} numbers under sweep, such as {FRACTION}"
        )
        raise misplaced(("refine",), problem, config.places)
    return keys


def _is_refinable(name: str, axis: Axis) -> bool:
    values = [choice.assignments.get(name) for choice in axis]
    are_whole = all(isinstance(value, int) and not isinstance(value, bool) for value in values)
    if (
        FILL in values
        or len(set(map(str, values))) < FEWEST_POINTS
        or name.split(".")[0] in UNREFINED
    ):
        return False
    return name == FRACTION or are_whole


def value_of(comparison: Comparison, key: str) -> Fraction:
    """Where a comparison is on an axis."""
    if key == FRACTION:
        return comparison.config.memory.share
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


def too_coarse(xs: Sequence[Fraction], curves: Sequence[Curve], tolerance: Fraction) -> list[int]:
    """Numbers i of the intervals from xs[i] to xs[i + 1] where a curve needs another point."""
    off = [0.0] * (len(xs) - 1)
    for curve in curves:
        if not all(values and all(map(math.isfinite, values)) for values in curve):
            continue  # no result, or something over nothing: no number of points makes a line of it
        means = [abs(fmean(values)) for values in curve]
        for i in range(1, len(xs) - 1):
            before, after = xs[i] - xs[i - 1], xs[i + 1] - xs[i]
            bend = _bend(curve[i - 1], curve[i], curve[i + 1], float(before / (before + after)))
            for left, step in ((i - 1, before), (i, after)):
                if curve[left] == curve[left + 1]:
                    continue
                share = float(step * step / (4 * before * after))
                level = min(means[left], means[left + 1])
                off[left] = max(off[left], bend * share / level if level else 0.0)
    return [i for i, error in enumerate(off) if error > tolerance]


def _bend(
    left: Sequence[float], here: Sequence[float], right: Sequence[float], weight: float
) -> float:
    """How far a point surely lies beside the line through its neighbours; 0 if it may lie on it."""
    beside = [
        value - ((1 - weight) * one + weight * other)
        for one, value, other in zip(left, here, right, strict=False)  # seeds that all three have
    ]
    noise = half_width(beside, CORRECTED) if len(beside) > 1 else math.inf
    return max(0.0, abs(fmean(beside)) - noise)


def between(low: Fraction, high: Fraction, *, whole: bool) -> Fraction | None:
    """A short number in the middle third; None if there is none.

    A whole number if asked for, else the one nearest to the middle with the fewest decimals.
    """
    middle, third = (low + high) / 2, (high - low) / 6
    for digits in range(1 if whole else 40):
        scale = 10**digits
        number = Fraction(round(middle * scale), scale)
        if (low < number < high) if whole else abs(number - middle) <= third:
            return number
    return None
