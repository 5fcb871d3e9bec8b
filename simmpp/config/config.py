"""From YAML text and ``--set`` to a checked configuration, and what a run needs of it."""

from __future__ import annotations

import copy
import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from os.path import exists
from pathlib import Path
from typing import Any

from pydantic_core import to_jsonable_python

from simmpp.common.errors import ConfigError
from simmpp.common.places import KeyPath, misplaced
from simmpp.common.strict import structure
from simmpp.common.units import shown
from simmpp.common.yamlfile import read_yaml
from simmpp.config.axes import Axis, axes_of
from simmpp.config.beside import folder_of, nearest, own_machine, reading_of
from simmpp.config.defaults import filled, lines_used
from simmpp.config.overrides import Override, Places, override, refuse_both, set_key
from simmpp.config.own_policies import with_files
from simmpp.config.reading import Line, Reading
from simmpp.config.settings import Settings
from simmpp.machine.layers import Layers
from simmpp.machine.machine import POLLED, TORUS, Machine
from simmpp.machine.presets import Preset, layered
from simmpp.machine.presets import machine as machine_of
from simmpp.methods.table import METHODS, SIMULATE
from simmpp.placement.placement import Memory, island_of
from simmpp.workload.exchange.columns import is_workload
from simmpp.workload.particles.settings import Particles
from simmpp.workload.particles.source import ParticleSource
from simmpp.workload.picture import Picture
from simmpp.workload.radiosity.source import RadiositySource
from simmpp.workload.ray_source import RaySource
from simmpp.workload.scene_settings import FILES
from simmpp.workload.sources import scene_of


@dataclass(frozen=True)
class Source:
    """What a configuration was made from, so that others can be made with some keys changed."""

    data: dict[str, Any]
    places: Places
    folder: Path
    may_run: bool = True
    """Files of policies may be run."""


@dataclass(frozen=True)
class Config:
    """A checked configuration."""

    settings: Settings
    folder: Path
    """Where relative scene files are looked for."""
    reading: Reading = field(repr=False, compare=False)
    """What stands for what the configuration does not say."""
    own_machine: Preset | None = field(default=None, repr=False)
    """That of the key machine.file."""
    source: Source | None = field(default=None, repr=False, compare=False)
    """Kept where points of a sweep are still to be made of it."""

    @property
    def processors(self) -> int:
        """Number of PEs."""
        return self.settings.processors

    @property
    def scene_spec(self) -> dict[str, object]:
        """The key ``scene`` written out, with file names that hold from here."""
        return self.settings.scene.within(self.folder).model_dump(exclude_none=True)

    @property
    def ray_source(self) -> RaySource:
        """Where the rays come from."""
        scene, radiosity = self.settings.scene.within(self.folder), self.settings.radiosity
        if radiosity is not None:
            return RadiositySource(scene_of(scene.source, "radiosity"), radiosity)
        if scene.cells is not None:
            return ParticleSource(scene.cells, self.settings.particles or Particles())
        return scene.source

    @property
    def axes(self) -> dict[str, Axis]:
        """The axes of the sweep, by their names."""
        return axes_of(self.settings.sweep)

    @property
    def kept_source(self) -> Source:
        """The source, of a configuration that keeps it."""
        if self.source is None:
            raise ValueError("expected a configuration that keeps its source")
        return self.source

    @property
    def places(self) -> Places:
        """Where each key was set, as far as that is known."""
        return self.source.places if self.source else {}

    @property
    def picture(self) -> Picture:
        """What is traced."""
        return self.settings.picture

    @property
    def asked(self) -> object:
        """What is made of the scene: settings that tell its rays from others."""
        return self.settings.radiosity or self.settings.particles or self.settings.picture

    @property
    def preset(self) -> str:
        """The preset that the machine is, or is based on."""
        return self.own_machine.based_on if self.own_machine else self.settings.machine.preset

    def machine_for(self, processors: int) -> Machine:
        """The machine with that many PEs.

        Raises ConfigError if the shape that the configuration gives has another number.
        """
        costs, overrides = self.reading.costs.get(self.preset), self.settings.machine
        return machine_of(self.preset, overrides, processors, costs=costs, own=self.own_machine)

    @property
    def layers(self) -> Layers:
        """What the machine is made of."""
        costs, overrides = self.reading.costs.get(self.preset), self.settings.machine
        return layered(self.preset, overrides, costs, self.own_machine)

    @property
    def lines_of_reading(self) -> list[Line]:
        """What the reading sets here, of a configuration that keeps its source."""
        given = self.settings.machine.flat()
        if self.own_machine:
            given |= self.own_machine.constants.flat()
        return lines_used(self.kept_source.data, self.settings, self.reading, self.preset, given)

    @property
    def memory(self) -> Memory:
        """Memory of one PE."""
        return self.settings.memory


def load_config(
    path: str | Path, overrides: Sequence[Override] = (), *, may_run: bool = True
) -> Config:
    """Read a configuration; ``overrides`` are ``KEY=VALUE`` as ``--set`` takes them, or options.

    The files of policies that it names are run, if they may.

    Raises ConfigError, one line with file, line, key, value and what was expected.
    """
    if is_workload(str(path)):
        hint = f"expected a configuration (YAML); `simmpp workload {path}` lists these rays"
        raise ConfigError(hint, where=str(path))
    if not exists(path) and Path(path).suffix in (".yaml", ".yml"):
        name = shlex.quote(str(path))
        raise ConfigError(
            f"there is no such file; `simmpp init {name}` writes one", where=str(path)
        )
    document = read_yaml(Path(path))
    where = document.where
    if document.data is None:
        raise ConfigError("the file is empty: expected at least the key 'scene'", where=where)
    if not isinstance(document.data, dict):
        raise ConfigError("expected keys with values, such as 'scene: mountain:5'", where=where)
    places: Places = {key: (where, line) for key, line in document.lines.items()}
    source = Source(document.data, places, Path(path).parent, may_run)
    return _checked(source, overrides)


def config_from_mapping(
    mapping: Mapping[str, object], overrides: Sequence[Override] = (), folder: Path = Path()
) -> Config:
    """Check a configuration given as Python data with the keys of the YAML file.

    ``overrides`` are ``KEY=VALUE`` as ``--set`` takes them; files are looked for from ``folder``.

    Raises ConfigError, one line with key, value and what was expected.
    """
    if not isinstance(mapping, Mapping):
        raise ConfigError(f"value {shown(mapping)}: expected a mapping of keys to values")
    data = copy.deepcopy(dict(mapping))
    places: Places = {(str(key),): ("", None) for key in data} if overrides else {}
    return _checked(Source(data, places, folder), overrides)


def with_key(config: Config, key: str, value: object) -> Config:
    """The same configuration and sweep, with one dotted key set."""
    source = config.kept_source
    data, places = copy.deepcopy(source.data), dict(source.places)
    set_key(data, key, value, places, ("", None))
    return _checked(Source(data, places, source.folder, source.may_run))


def _checked(source: Source, overrides: Sequence[Override] = ()) -> Config:
    """The configuration, once it and all values that are swept are found right."""
    refuse_both(overrides)
    for assignment in overrides:
        override(source.data, assignment, source.places)
    config = _structured(source)
    axes = config.axes
    first = dict.fromkeys(axes, 0)
    point_at(config, axes, first)
    for name, axis in axes.items():
        for n in range(1, len(axis)):
            point_at(config, axes, {**first, name: n})
    return config


def point_at(config: Config, axes: Mapping[str, Axis], chosen: Mapping[str, int]) -> Config:
    """The configuration of one combination: ``chosen`` is the number of the choice of each axis.

    Raises ConfigError where the values do not go together.
    """
    assignments = [
        (key, value, ("sweep", name, n))
        for name, n in chosen.items()
        for key, value in axes[name][n].assignments.items()
    ]
    point = changed(config, sorted(assignments, key=lambda assigned: assigned[0].count(".")))
    try:
        machine = point.machine_for(point.processors)
    except ConfigError as error:
        key = ("machine", *error.where.split("."))
        raise misplaced(key, error.problem, point.places) from None
    try:
        island_of(point.settings.placement, point.processors)
    except ConfigError as error:
        raise misplaced(tuple(error.where.split(".")), error.problem, point.places) from None
    method = point.settings.method
    if METHODS[method].knows_papers_machine_alone and (other := _other(point, machine)):
        problem = f"value {method!r}: expected {SIMULATE} where {other}"
        raise misplaced(("method",), problem, point.places)
    return point


def _other(point: Config, machine: Machine) -> str:
    """What the paper's model does not know of a point; empty if there is nothing."""
    if machine.topology != TORUS:
        return f"the topology is {machine.topology}"
    if machine.service != POLLED:
        return f"the service is {machine.service}"
    if machine.is_uneven:
        return "a machine has compute_startup, least_tests, speed, noise or straggler"
    return "there are islands" if point.settings.placement.islands > 1 else ""


def changed(config: Config, assignments: Iterable[tuple[str, object, KeyPath]]) -> Config:
    """The configuration without its sweep, and with dotted keys set one after the other.

    Each comes with the path of what set it in the configuration's file.
    """
    source = config.kept_source
    data = copy.deepcopy({key: value for key, value in source.data.items() if key != "sweep"})
    places = {path: place for path, place in source.places.items() if path[:1] != ("sweep",)}
    for key, value, path in assignments:
        set_key(data, key, copy.deepcopy(value), places, nearest(source.places, path))
    return _structured(Source(data, places, source.folder, source.may_run))


def _structured(source: Source) -> Config:
    data, places, folder = source.data, source.places, source.folder
    reading = reading_of(data, places, folder)
    read = with_files(
        data, places, lambda path: folder_of([path], places, folder), may_run=source.may_run
    )
    settings = structure(Settings, filled(read, reading), places)
    scenes = folder_of([("scene", key) for key in (*FILES, "parts")], places, folder)
    return Config(settings, scenes, reading, own_machine(settings.machine, places, folder), source)


def described(config: Config) -> dict[str, Any]:
    """The configuration with its defaults, as JSON can hold it and as a user could write it."""
    values = config.settings.model_dump(exclude_none=True)
    plain: dict[str, Any] = to_jsonable_python(values, fallback=str, inf_nan_mode="constants")
    return plain
