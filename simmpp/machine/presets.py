"""Machines of the package and of one's own: constants with the source of each, made into a Machine.

A preset is a YAML file of the package. One's own machine is such a file as well, ``based_on`` a
preset, whose constants it has where it says nothing; its values need no source. Constants may have
a range beside the value.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache, lru_cache
from importlib.resources import as_file, files
from math import prod
from os.path import isfile
from pathlib import Path
from types import NoneType

from simmpp.common.errors import ConfigError
from simmpp.common.places import KeyPath, Place
from simmpp.common.sourced import Cited, values_of
from simmpp.common.strict import in_words, structure
from simmpp.common.units import shown
from simmpp.common.validate import require_kind, require_whole, require_word
from simmpp.common.yamlfile import Document, parse_yaml, read_yaml, yaml_text
from simmpp.machine.constants import Constants, machine_of
from simmpp.machine.layers import Layers
from simmpp.machine.machine import MOST_PROCESSORS, TORUS, Machine, Shape, is_shape
from simmpp.machine.ranges import Known, Ranges, known_of, ranges_of, spans_of, written
from simmpp.machine.topology import topology_of
from simmpp.machine.torus import default_shape
from simmpp.machine.uneven import check_unlike

_FOLDER = files("simmpp") / "machine" / "presets"
OVERRIDDEN = "set by you"
DEFAULT_PRESET = "t3e"
SUFFIXES = (".yaml", ".yml")


@dataclass(frozen=True)
class Preset:
    """A machine as far as its documents and estimates describe it."""

    name: str
    description: str
    constants: Constants
    texts: dict[str, str]
    """Each constant as the preset's file writes it, with its unit, by dotted key."""
    sources: dict[str, str]
    """A citation for each constant, or ESTIMATE; by the same keys."""
    spans: dict[str, str] = field(default_factory=dict)
    """The range of each constant that has one, written likewise; by the same keys."""
    ranges: Ranges = field(default_factory=dict)
    """The same as numbers, by the keys of ``Constants.flat``."""
    based_on: str = ""
    """The preset below it, if it is a machine of one's own."""

    @property
    def known(self) -> dict[str, Known]:
        """Value, range and source of each constant, by the keys of ``Constants.flat``."""
        numbers = self.constants.flat()
        return known_of(numbers, {key: self.source(key) for key in numbers}, self.ranges)

    def text(self, key: str, write: Callable[[int], str]) -> str:
        """A constant with its unit, written by ``write`` where the file has it for all messages."""
        numbers = self.constants.flat()
        return self.texts.get(key) or (write(numbers[key]) if key in numbers else "")

    def source(self, key: str) -> str:
        """Of a constant; of a whole that is told part by part, whoever tells."""
        if any(cited.startswith(f"{key}.") for cited in self.sources):
            return OVERRIDDEN
        return self.sources[self.written(key)]

    def written(self, key: str) -> str:
        """The file's key of a constant: ``pack.fixed`` there says what ``pack.rays.fixed`` is."""
        return written(key, self.sources)


def preset_names() -> list[str]:
    """Names that ``load_preset`` knows."""
    names = (entry.name for entry in _FOLDER.iterdir())
    return sorted(name.removesuffix(".yaml") for name in names if name.endswith(".yaml"))


@cache
def load_preset(name: str) -> Preset:
    """Read one of the package's machines.

    Raises ConfigError if there is none of that name.
    """
    if name not in preset_names():
        expected = ", ".join(preset_names())
        raise ConfigError(f"value {shown(name)}: expected a preset: {expected}")
    with as_file(_FOLDER / f"{name}.yaml") as path:
        document = read_yaml(path)
    return _preset(name, document)


def load_own(name: str, folder: Path = Path()) -> Preset:
    """Read a machine of one's own, from a file that is looked for from ``folder``.

    Raises ConfigError if there is none, or for what is wrong in it, with file and line.
    """
    path = folder / name
    if not name.endswith(SUFFIXES) or not isfile(path):
        raise ConfigError(f"value {shown(name)}: expected a file .yaml that exists")
    return _own(path.stem, yaml_text(path), str(path))


@lru_cache(maxsize=32)  # every point of a sweep asks again
def _own(name: str, text: str, where: str) -> Preset:
    return _preset(name, parse_yaml(text, where), own=True)


def _preset(name: str, document: Document, *, own: bool = False) -> Preset:
    places: dict[KeyPath, Place] = {
        path[1:]: (document.where, line)
        for path, line in document.lines.items()
        if path[:1] == ("constants",)
    }
    data, keys = document.data, ["description", *(["based_on"] if own else []), "constants"]
    if not isinstance(data, dict) or set(data) != set(keys):
        raise ConfigError(f"expected the keys {', '.join(keys)}", where=document.where)
    base = data.get("based_on", "")
    if own and base not in preset_names():
        problem = f"based_on: value {shown(base)}: expected {in_words(tuple(preset_names()))}"
        line = document.lines.get(("based_on",))
        raise ConfigError(problem, where=document.where, line=line)
    cited = Cited()
    values = values_of(data["constants"], cited, places, unsaid=OVERRIDDEN if own else "")
    constants = structure(Constants, values, places)
    ranges = ranges_of(values, cited, places)
    description = " ".join(str(data["description"]).split())
    spans = spans_of(cited)
    return Preset(name, description, constants, cited.texts, cited.sources, spans, ranges, base)


def machine(
    preset: str = DEFAULT_PRESET,
    overrides: Mapping[str, object] | Constants | None = None,
    processors: int = 64,
    shape: Shape | None = None,
    costs: Preset | None = None,
    own: Preset | None = None,
) -> Machine:
    """A preset's machine of ``processors`` PEs, with some constants overridden.

    ``overrides`` has the keys of a configuration's ``machine``: ``{"send_startup": "5 us"}``;
    ``costs``, of a reading, and ``own``, of a file, are constants between preset and overrides,
    with sources of their own. The torus is ``shape``, else the overrides' shape, else the most
    cubic one.
    Raises ConfigError for a wrong constant or a network that doesn't hold ``processors`` PEs.
    """
    require_word("preset", preset, preset_names())
    require_kind("overrides", overrides, Mapping, Constants, NoneType)
    if not isinstance(overrides, Constants):
        overrides = structure(Constants, dict(overrides or {}), {})
    layers = layered(preset, overrides, costs, own)
    made = machine_of(
        layers.numbers,
        name=own.name if own else preset,
        shape=_shape(processors, overrides.shape if shape is None else shape, layers.words),
        levels=layers.levels(),
        **layers.words,
        **layers.unlike,
        sources=layers.sources,
    )
    topology_of(made)  # refuses what can't be
    check_unlike(made.speed, made.noise, made.straggler, made.processors)
    return made


def layered(
    preset: str, overrides: Constants, costs: Preset | None = None, own: Preset | None = None
) -> Layers:
    """What all that a machine is made of says together, as in ``machine``.

    Raises ConfigError for what is set in vain.
    """
    layers = Layers()
    for layer in (load_preset(preset), costs, own):
        if layer is not None:
            layers.put(layer.constants, layer.source, layer.ranges)
    if own is not None:
        layers.refuse_strangers(own.constants)
    layers.put(overrides, lambda key: OVERRIDDEN)
    layers.refuse_strangers(overrides)
    return layers


def _shape(processors: int, shape: Shape | None, words: Mapping[str, str]) -> Shape:
    """``shape`` if it holds ``processors`` PEs, the most cubic torus where it is None.

    Raises ConfigError otherwise.
    """
    require_whole("processors", processors, 1, MOST_PROCESSORS)
    if shape is not None and not (is_shape(shape) and prod(shape) == processors):
        value = list(shape) if isinstance(shape, tuple) else shape
        expected = f"three integers whose product is processors = {processors}"
        raise ConfigError(f"value {shown(value)}: expected {expected}", where="shape")
    if words["topology"] != TORUS:
        return processors, 1, 1  # all in a row: a shape is the torus' alone
    return shape or default_shape(processors)
