"""What Python callers may pass: numbers and words that a configuration would have refused, too."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from numbers import Integral
from pathlib import Path
from types import NoneType

from simmpp.common.errors import ConfigError
from simmpp.common.units import shown

MOST_COUNT = 2**31 - 1
"""Rays, objects and PEs are numbered by int32."""
MOST_SEED = 2**63 - 1


def whole(value: object, least: int, most: int, name: str = "") -> int:
    """``value`` if it is an integer, Python's or numpy's, in that range; else ConfigError."""
    if isinstance(value, Integral) and not isinstance(value, bool) and least <= int(value) <= most:
        return int(value)
    prefix = f"{name}: " if name else ""
    raise ConfigError(f"{prefix}value {shown(value)}: expected an integer from {least} to {most}")


def require_whole(name: str, value: object, least: int, most: int = MOST_COUNT) -> None:
    """Raise ConfigError unless ``value`` is an integer, Python's or numpy's, in that range."""
    whole(value, least, most, name)


def require_word(name: str, value: object, words: Sequence[str]) -> None:
    """Raise ConfigError unless ``value`` is one of ``words``."""
    if not (isinstance(value, str) and value in words):
        expected = ", ".join(words)
        raise ConfigError(f"{name}: value {shown(value)}: expected one of {expected}")


def require_kind(name: str, value: object, *kinds: type) -> None:
    """Raise ConfigError unless ``value`` is an instance of one of the classes."""
    if not isinstance(value, kinds):
        expected = " or ".join(_WORDS.get(kind, f"a {kind.__name__}") for kind in kinds)
        raise ConfigError(f"{name}: value {shown(value)}: expected {expected}")


_WORDS: dict[type, str] = {
    **{str: "a text", os.PathLike: "a path", Path: "a path", NoneType: "none"},
    **{Mapping: "a mapping", Sequence: "a list", float: "a number", int: "an integer"},
}
"""Classes as users know them."""
