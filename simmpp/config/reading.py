"""Readings: defaults of policies, placement, memory and costs, each with what it rests on.

A paper leaves much open, and what is taken for it decides what comes out. A reading says it in one
place: a YAML file of the package, or of one's own, in which every value has its source. Keys are
those of a configuration, but for the policies, which are below their names, and the costs, which
are below the preset that they are for.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import as_file, files
from os.path import isfile
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import create_model

from simmpp.common.errors import ConfigError
from simmpp.common.places import KeyPath, Place, misplaced
from simmpp.common.sourced import Cited, values_of
from simmpp.common.strict import Strict, in_words, structure
from simmpp.common.units import shown
from simmpp.common.yamlfile import Document, parse_yaml, yaml_text
from simmpp.machine.constants import UNLIKE, Constants
from simmpp.machine.presets import Preset, preset_names
from simmpp.machine.ranges import ranges_of, spans_of
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.policy.parameters import POLICIES, PolicyParameters

Places = dict[KeyPath, Place]
_FOLDER = files("simmpp") / "config" / "readings"
_SUFFIXES = (".yaml", ".yml")
DESCRIPTION, BASE, MACHINE, POLICY = "description", "based_on", "machine", "policy"
_NOT_IN_ONE: dict[str, tuple[str, ...]] = {
    # no costs, but choices
    MACHINE: ("shape", "topology", "levels", "fat_tree", "service", "contention", *UNLIKE),
    POLICY: ("name", "label", "file", "set"),  # a reading is no code
}
"""Keys of a configuration that no reading sets."""


def _below(cls: type, names: Any) -> Any:
    """A class of settings with a ``cls`` for each name, all of which may be left out."""
    fields: dict[str, Any] = {name: (cls | None, None) for name in names}
    return create_model(f"{cls.__name__}ByName", __base__=Strict, **fields)


_Policies: Any = _below(PolicyParameters, POLICIES)
_Machines: Any = _below(Constants, preset_names())


class _Keys(Strict):
    """What a reading may set; its values are checked by being put in here."""

    placement: PlacementRules = PlacementRules()
    memory: Memory = Memory()
    policy: _Policies = _Policies()
    machine: _Machines = _Machines()


class Line(NamedTuple):
    """One value that a reading sets."""

    key: str
    """``placement.pixels``, ``policy.concurrent.packing``, ``machine.t3e.test``."""
    value: str
    """As the file writes it, with its unit."""
    source: str
    """A sentence of the paper, or ESTIMATE, or what else it rests on."""
    span: str = ""
    """The range of a constant that may be off."""


@dataclass(frozen=True, eq=False)
class Reading:
    """Defaults that stand between a preset and a configuration."""

    name: str
    """As a configuration writes it."""
    description: str
    values: Mapping[str, Mapping[str, Any]]
    """Those of ``placement`` and ``memory``, as users write them."""
    policies: Mapping[str, Mapping[str, Any]]
    """Those of each policy, by its name."""
    costs: Mapping[str, Preset]
    """Constants, by the preset that they are for."""
    lines: tuple[Line, ...]
    """All of it."""

    def policy(self, name: str) -> PolicyParameters:
        """A policy of which nothing is said but its name."""
        return structure(PolicyParameters, {"name": name, **self.policies.get(name, {})}, {})


def reading_names() -> list[str]:
    """Readings of the package."""
    names = (entry.name for entry in _FOLDER.iterdir())
    return sorted(name.removesuffix(".yaml") for name in names if name.endswith(".yaml"))


def load_reading(name: str, folder: Path = Path()) -> Reading:
    """A reading of the package, or a file that is looked for from ``folder``.

    Raises ConfigError if there is none, or for what is wrong in its file, with file and line.
    """
    if name in reading_names():
        return _reading(name, *_of_package(name))
    path = folder / name
    if not name.endswith(_SUFFIXES) or not isfile(path):
        names = in_words(tuple(reading_names()))
        raise ConfigError(f"value {shown(name)}: expected {names}, or a file .yaml that exists")
    return _reading(name, yaml_text(path), str(path))


def _of_package(name: str) -> tuple[str, str]:
    with as_file(_FOLDER / f"{name}.yaml") as path:
        return yaml_text(path), str(path)


@lru_cache(maxsize=32)  # every point of a sweep asks again
def _reading(name: str, text: str, where: str) -> Reading:
    description, parts, places = _parts(parse_yaml(text, where))
    cited = Cited()
    values = values_of(parts, cited, places)
    _refuse_choices(values, places)
    _refuse_ranges(cited, places)
    keys = structure(_Keys, _with_names(values), places)
    costs = {
        preset: _costs(preset, keys, of, cited, places)
        for preset, of in values.get(MACHINE, {}).items()
    }
    return Reading(
        name,
        description,
        {key: values[key] for key in ("placement", "memory") if key in values},
        values.get(POLICY, {}),
        costs,
        tuple(_lines(cited)),
    )


def _lines(cited: Cited) -> Iterator[Line]:
    spans = spans_of(cited)
    for key, text in cited.texts.items():
        yield Line(key, text, cited.sources[key], spans.get(key, ""))


def _parts(document: Document) -> tuple[str, dict[str, Any], Places]:
    """The description; what a file sets, over what its base sets; and where each of it stands."""
    data = document.data
    description = data.get(DESCRIPTION) if isinstance(data, dict) else None
    if not isinstance(data, dict) or not isinstance(description, str):
        problem = f"expected a text {DESCRIPTION}, and what the reading sets"
        raise ConfigError(problem, where=document.where)
    places: Places = {path: (document.where, line) for path, line in document.lines.items()}
    parts = {key: part for key, part in data.items() if key not in (DESCRIPTION, BASE)}
    description = " ".join(description.split())
    if BASE not in data:
        return description, parts, places
    if data[BASE] not in reading_names():
        problem = f"value {shown(data[BASE])}: expected {in_words(tuple(reading_names()))}"
        raise misplaced((BASE,), problem, places)
    _, base, base_places = _parts(parse_yaml(*_of_package(data[BASE])))
    whole = {
        part: _over(base.get(part, {}), parts.get(part, {}), 2 if part in (MACHINE, POLICY) else 1)
        for part in base | parts
    }
    return description, whole, base_places | places


def _over(below: Any, above: Any, depth: int) -> Any:
    """What is above, and what is below it of keys that are not above, down to a depth."""
    if depth == 0 or not isinstance(below, dict) or not isinstance(above, dict):
        return above
    both = {key: _over(below[key], above[key], depth - 1) for key in below if key in above}
    return below | above | both


def _refuse_choices(values: Mapping[str, Any], places: Mapping[KeyPath, Place]) -> None:
    """Raise ConfigError for what only configurations say."""
    for part, choices in _NOT_IN_ONE.items():
        below = values.get(part)
        for name, given in below.items() if isinstance(below, dict) else ():
            if chosen := [key for key in choices if isinstance(given, dict) and key in given]:
                path = (part, name, chosen[0])
                key = "" if path in places else f"{chosen[0]}: "  # of a section as one value
                raise misplaced(path, f"{key}expected none: readings do not set it", places)


def _refuse_ranges(cited: Cited, places: Mapping[KeyPath, Place]) -> None:
    """Raise ConfigError for a range of what is no constant of a machine."""
    for key in cited.ranges:
        path = tuple(key.split("."))
        if path[0] != MACHINE:
            raise misplaced((*path, "range"), "expected none: machines have ranges", places)


def _with_names(values: Mapping[str, Any]) -> Mapping[str, Any]:
    """The values, with each policy's name where ``structure`` looks for it."""
    if not isinstance(policies := values.get(POLICY), dict):
        return values
    named = {
        name: {"name": name, **given} if isinstance(given, dict) else given
        for name, given in policies.items()
    }
    return {**values, POLICY: named}


def _costs(
    preset: str, keys: _Keys, values: Mapping[str, Any], cited: Cited, places: Places
) -> Preset:
    of_preset = cited.below(f"{MACHINE}.{preset}.")
    constants = getattr(keys.machine, preset)
    at_preset = {path[2:]: place for path, place in places.items() if path[:1] == (MACHINE,)}
    ranges = ranges_of(values, of_preset, at_preset)
    spans = spans_of(of_preset)
    return Preset(preset, "", constants, of_preset.texts, of_preset.sources, spans, ranges)
