"""What made some results: versions, and what differs between two of such records."""

from __future__ import annotations

import platform
import re
from collections.abc import Mapping
from functools import cache
from importlib.metadata import version
from typing import Any

from simmpp.common.code.source import source_digest
from simmpp.common.modules import METHODS, PLACEMENT, TRACER

LIBRARIES = ("simmpp", "numpy", "numba", "simpy", "embreex", "mapbox-earcut")
"""Libraries that rays, draws and simulated times pass through."""
DECIDING = (TRACER, PLACEMENT, METHODS)
"""Modules that, with all that they import, decide what results are."""


@cache
def result_versions() -> dict[str, str]:
    """Versions that results may depend on; ``simmpp source`` notices a changed checkout.

    Python's isn't among them: all arithmetic is integer, numpy's or numba's.
    """
    return {name: version(name) for name in LIBRARIES} | {"simmpp source": source_digest(*DECIDING)}


def all_versions() -> dict[str, str]:
    """The same with Python's, for the record."""
    return {"python": platform.python_version()} | result_versions()


def difference(
    a: Mapping[str, Any], b: Mapping[str, Any], name_a: str = "there", name_b: str = "now"
) -> str:
    """The first keys in which two records differ with both values; empty if they are equal.

    Digests are named only where nothing else tells the two apart.
    """
    flat_a, flat_b = _flat(a), _flat(b)
    keys = [key for key in {**flat_a, **flat_b} if flat_a.get(key) != flat_b.get(key)]
    keys = [key for key in keys if not _has_digest(flat_a, flat_b, key)] or keys
    parts = [
        f"{key} is {_text(flat_a, key)} {name_a}, {_text(flat_b, key)} {name_b}" for key in keys[:3]
    ]
    more = [f"and {len(keys) - 3} more"] if len(keys) > 3 else []
    return "; ".join(parts + more)


def _has_digest(a: Mapping[str, Any], b: Mapping[str, Any], key: str) -> bool:
    return any(re.search("[0-9a-f]{32}", str(flat.get(key))) for flat in (a, b))


def _flat(record: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in record.items():
        if isinstance(value, Mapping) and value:
            flat |= _flat(value, f"{prefix}{key}.")
        else:
            flat[f"{prefix}{key}"] = value
    return flat


def _text(flat: Mapping[str, Any], key: str) -> str:
    return str(flat[key]) if key in flat else "not given"
