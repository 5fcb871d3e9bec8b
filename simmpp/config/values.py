"""Values of a configuration that are neither a number, a word nor a quantity with a unit.

Each function returns the value checked, or raises ConfigError with what was expected.
"""

from __future__ import annotations

from fractions import Fraction

from simmpp.common.errors import ConfigError
from simmpp.common.units import share, shown
from simmpp.common.validate import MOST_SEED
from simmpp.config.axes import axes_of

AXES = "a mapping of keys to lists, such as {memory.fraction: [0.1, 0.5, 1]}"
SEEDS = f"a list of different integers from 0 to {MOST_SEED}, such as [0, 1, 2]"
TOLERANCE = "none, or a share above 0% and below 100%, such as 2%"


def seeds(value: object) -> tuple[int, ...]:
    """Different seeds, at least one."""
    if not isinstance(value, list | tuple):
        raise ConfigError(f"value {shown(value)}: expected {SEEDS}")
    for seed in value:
        if not isinstance(seed, int) or isinstance(seed, bool) or not 0 <= seed <= MOST_SEED:
            raise ConfigError(f"value {shown(seed)} in the list: expected {SEEDS}")
    if not 0 < len(set(value)) == len(value):
        raise ConfigError(f"value {shown(value)}: expected {SEEDS}")
    return tuple(value)


def tolerance(value: object) -> Fraction | None:
    """A share between 0 and 1, or None."""
    if value in ("none", None):
        return None
    try:
        tolerance = share(value)
    except ConfigError:
        tolerance = Fraction(0)
    if not 0 < tolerance < 1:
        raise ConfigError(f"value {shown(value)}: expected {TOLERANCE}")
    return tolerance


def axes(value: object) -> object:
    """Axes of a sweep; the keys themselves are checked later."""
    if not isinstance(value, dict):
        raise ConfigError(f"value {shown(value)}: expected {AXES}")
    axes_of(value)
    return value
