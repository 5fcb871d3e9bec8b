"""What Python callers may pass: numbers and words that a configuration would have refused, too."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from numbers import Integral

from simmpp.common.errors import ConfigError
from simmpp.common.units import shown

MOST_COUNT = 2**31 - 1
"""Rays, objects and PEs are numbered by int32."""
MOST_SEED = 2**63 - 1


def require_whole(name: str, value: object, least: int, most: int = MOST_COUNT) -> None:
    """Raise ConfigError unless ``value`` is an integer, Python's or numpy's, in that range."""
    whole = isinstance(value, Integral) and not isinstance(value, bool)
    if not (whole and least <= value <= most):  # type: ignore[operator]
        expected = f"an integer from {least} to {most}"
        raise ConfigError(f"{name}: value {shown(value)}: expected {expected}")


def require_share(name: str, value: object) -> None:
    """Raise ConfigError unless ``value`` is a number from 0 to 1."""
    number = isinstance(value, int | float | Fraction) and not isinstance(value, bool)
    if not (number and 0 <= value <= 1):  # type: ignore[operator]
        raise ConfigError(f"{name}: value {shown(value)}: expected a share from 0 to 1")


def require_word(name: str, value: object, words: Sequence[str]) -> None:
    """Raise ConfigError unless ``value`` is one of ``words``."""
    if not (isinstance(value, str) and value in words):
        expected = ", ".join(words)
        raise ConfigError(f"{name}: value {shown(value)}: expected one of {expected}")
