"""Values with the source of each, as presets and readings write them in YAML."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from simmpp.common.places import KeyPath, Place, misplaced
from simmpp.common.yamlfile import written


@dataclass(frozen=True)
class Cited:
    """What a file says beside its values, by dotted key."""

    texts: dict[str, str] = field(default_factory=dict)
    """Each value as the file writes it, with its unit."""
    sources: dict[str, str] = field(default_factory=dict)
    """A citation for each value, or ESTIMATE and the range."""


def values_of(
    node: object,
    cited: Cited,
    places: Mapping[KeyPath, Place],
    path: KeyPath = (),
    unsaid: str = "",
) -> Any:
    """``{value, source}`` leaves reduced to their values; the rest goes into ``cited``.

    With ``unsaid`` a value may stand alone, and that is its source.
    Raises ConfigError, with its place, for what is neither such a leaf nor a mapping of them.
    """
    match node:
        case {"value": value, "source": str(source), **others} if (
            path and source.strip() and not others
        ):
            key = ".".join(map(str, path))
            cited.texts[key], cited.sources[key] = written(value), " ".join(source.split())
            return value
        case dict() if "value" not in node or not path:  # the whole is no leaf
            return {
                key: values_of(child, cited, places, (*path, key), unsaid)
                for key, child in node.items()
            }
        case str() | int() | list() if unsaid and path:
            key = ".".join(map(str, path))
            cited.texts[key], cited.sources[key] = str(node), unsaid
            return node
    raise misplaced(path, "expected {value: ..., source: ...}", places)
