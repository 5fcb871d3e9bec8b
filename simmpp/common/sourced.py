"""Values with the source of each, and its range, as presets and readings write them in YAML."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from simmpp.common.places import KeyPath, Place, misplaced
from simmpp.common.units import shown
from simmpp.common.yamlfile import written

T = TypeVar("T")


@dataclass(frozen=True)
class Cited:
    """What a file says beside its values, by dotted key."""

    texts: dict[str, str] = field(default_factory=dict)
    """Each value as the file writes it, with its unit."""
    sources: dict[str, str] = field(default_factory=dict)
    """A citation for each value, or ESTIMATE."""
    ranges: dict[str, tuple[Any, Any]] = field(default_factory=dict)
    """The least and the greatest that a value may really be, where the file says it."""

    def below(self, prefix: str) -> Cited:
        """What is said of the keys that begin so, by the rest of each."""

        def cut(by_key: dict[str, T]) -> dict[str, T]:
            found = {key: said for key, said in by_key.items() if key.startswith(prefix)}
            return {key.removeprefix(prefix): said for key, said in found.items()}

        return Cited(cut(self.texts), cut(self.sources), cut(self.ranges))


def values_of(
    node: object,
    cited: Cited,
    places: Mapping[KeyPath, Place],
    path: KeyPath = (),
    unsaid: str = "",
) -> Any:
    """``{value, range, source}`` leaves reduced to their values; the rest goes into ``cited``.

    The range may be left out. With ``unsaid`` a value may stand alone, and the source be left out,
    which then is that.
    Raises ConfigError, with its place, for what is neither such a leaf nor a mapping of them.
    """
    match node:
        case {"value": value, **said} if path and said.keys() <= {"range", "source"}:
            source, span = said.get("source", unsaid), said.get("range")
            if isinstance(source, str) and source.strip():
                key = ".".join(map(str, path))
                cited.texts[key], cited.sources[key] = written(value), " ".join(source.split())
                if span is not None:
                    cited.ranges[key] = _two_ends(span, path, places)
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


def _two_ends(span: object, path: KeyPath, places: Mapping[KeyPath, Place]) -> tuple[Any, Any]:
    if not isinstance(span, list) or len(span) != 2:
        problem = f"value {shown(span)}: expected two values, such as [5 us, 20 us]"
        raise misplaced((*path, "range"), problem, places)
    return span[0], span[1]
