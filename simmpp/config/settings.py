"""The keys of a configuration: what each means, takes and defaults to.

Those of a part stand beside what reads them: ``workload.picture``, ``placement.placement``,
``policy.parameters``, ``machine.machine``.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated

from pydantic import Field, field_validator, model_validator

from simmpp.common.errors import ConfigError
from simmpp.common.quantities import SHARE_TEXT
from simmpp.common.strict import (
    Expect,
    Short,
    Strict,
    Switch,
    in_words,
    integer,
    is_line,
    mistake,
    one_of,
    only,
    parsed_by,
)
from simmpp.common.units import share, shown
from simmpp.common.validate import MOST_SEED
from simmpp.config.advice import AdviseSettings
from simmpp.config.axes import axes_of
from simmpp.engine.simulate import DEFAULT_ENGINE, ENGINES, READY_ORDERS
from simmpp.machine.constants import Constants
from simmpp.machine.machine import MOST_PROCESSORS
from simmpp.machine.presets import DEFAULT_PRESET, preset_names
from simmpp.methods.table import METHODS, SIMULATE
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.policy.parameters import NAME, POLICIES, PolicyParameters
from simmpp.policy.policy import Policy
from simmpp.workload.particles.settings import Particles
from simmpp.workload.picture import Picture
from simmpp.workload.radiosity.settings import Radiosity
from simmpp.workload.sources import SceneKey

_AXES = "a mapping of keys to lists, such as {memory.fraction: [0.1, 0.5, 1]}"
_SEEDS = f"a list of different integers from 0 to {MOST_SEED}, such as [0, 1, 2]"
_TOLERANCE = "none, or a share above 0% and below 100%, such as 2%"
_SCENE = Short("a text such as mountain:5 or bunny.glb", {"type": "string"})
_OPEN = {"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1}
_SHARE = {"anyOf": [{"enum": ["none", None]}, _OPEN, SHARE_TEXT]}
_SEED = {"type": "integer", "minimum": 0, "maximum": MOST_SEED}
_SEEDS_SCHEMA = {"type": "array", "items": _SEED, "minItems": 1, "uniqueItems": True}


def _seeds(value: object) -> tuple[int, ...]:
    """Different seeds, at least one."""
    if not isinstance(value, list | tuple):
        raise ConfigError(f"value {shown(value)}: expected {_SEEDS}")
    for seed in value:
        if not isinstance(seed, int) or isinstance(seed, bool) or not 0 <= seed <= MOST_SEED:
            raise ConfigError(f"value {shown(seed)} in the list: expected {_SEEDS}")
    if not 0 < len(set(value)) == len(value):
        raise ConfigError(f"value {shown(value)}: expected {_SEEDS}")
    return tuple(value)


def _tolerance(value: object) -> Fraction | None:
    """A share between 0 and 1, or None."""
    if value in ("none", None):
        return None
    try:
        tolerance = share(value)
    except ConfigError:
        tolerance = Fraction(0)
    if not 0 < tolerance < 1:
        raise ConfigError(f"value {shown(value)}: expected {_TOLERANCE}")
    return tolerance


def _axes(value: object) -> object:
    """Axes of a sweep; the keys themselves are checked later."""
    if not isinstance(value, dict):
        raise ConfigError(f"value {shown(value)}: expected {_AXES}")
    axes_of(value)
    return value


DEFAULT_READING = "mixed"
"""What holds where a configuration names none."""
_READING = "a reading of the package such as plain, or a file such as readings/own.yaml"
ReadingName = Annotated[str, *only(is_line, Expect(_READING, {"type": "string", "minLength": 1}))]
_FILE = "a file such as ours.yaml"
_TRACED = "a scene that is traced"
ASKED = {"picture": _TRACED, "radiosity": _TRACED, "particles": "scene.cells"}
"""Keys of which each says what rays are for, and with what it goes."""
FileName = Annotated[str, *only(is_line, Expect(_FILE, {"type": "string", "minLength": 1}))]
Tolerance = Annotated[Fraction | None, parsed_by(_tolerance), Expect(_TOLERANCE, _SHARE)]


class MachineSettings(Constants):
    """The simulated machine: a preset, and any of its constants overridden."""

    preset: Annotated[str, *one_of(*preset_names())] = DEFAULT_PRESET
    """A machine of the package (see `simmpp machine PRESET`)."""
    file: FileName | None = None
    """A machine of one's own: a YAML file with a description, based_on a preset, and its constants
    (see `simmpp machine FILE`)."""

    @model_validator(mode="after")
    def _is_named_once(self) -> MachineSettings:
        if self.file is not None and "preset" in self.model_fields_set:
            raise mistake("file says itself what it is based on: expected no key preset beside it")
        return self


def long_policies(value: object) -> list[object]:
    """One policy is a list of one, and a name or an object of Python alone a mapping."""
    entries = value if isinstance(value, list | tuple) else [value]
    return [_long(entry) for entry in entries]


def _long(entry: object) -> object:
    if isinstance(entry, Policy):
        return {"file": entry}
    return {"name": entry} if isinstance(entry, str) else entry


def policies(value: object) -> object:
    """The same, once each entry is found to be a name or a mapping."""
    entries = long_policies(value)
    for entry in entries:
        if not isinstance(entry, dict):
            names = in_words(tuple(POLICIES))
            raise ConfigError(f"value {shown(entry)}: expected {names}, or a mapping")
    return entries


class CheckSettings(Strict):
    """What `simmpp check` allows; without any of these, every integer must be the baseline's."""

    time_profit: Tolerance = None
    """Relative change of the time profit that `check` allows."""
    message_profit: Tolerance = None
    """Likewise of the message profit; what isn't named isn't compared."""
    speedup: Tolerance = None
    """Likewise of the speedup."""
    efficiency: Tolerance = None
    """Likewise of the efficiency."""

    @property
    def tolerances(self) -> dict[str, Fraction]:
        """Relative change allowed of each profit named."""
        return {name: share for name, share in self if share is not None}


class Settings(Strict):
    """A whole configuration."""

    scene: Annotated[SceneKey, _SCENE]
    """What is rendered."""
    reading: ReadingName = DEFAULT_READING
    """Defaults of policies, placement, memory and costs together, each with its source: what one
    takes the paper to mean (see `simmpp reading NAME`)."""
    picture: Picture = Picture()
    """Rays that are traced."""
    radiosity: Radiosity | None = None
    """Light between patches of the scene, in place of a picture."""
    particles: Particles | None = None
    """Particles through the cells of `scene.cells`, in place of a picture."""
    machine: MachineSettings = MachineSettings()
    """What computes it."""
    processors: Annotated[int, *integer(1, MOST_PROCESSORS, "PEs")] = 64
    """Number of PEs, nb in the paper."""
    memory: Memory = Memory()
    """Memory of one PE."""
    placement: PlacementRules = PlacementRules()
    """Where objects and pixels are."""
    ready_order: Annotated[str, *one_of(*READY_ORDERS)] = "depth-first"
    """New ready rays go to the front, or to the back."""
    policy: Annotated[tuple[PolicyParameters, ...], parsed_by(policies), NAME] = (
        PolicyParameters(),
    )
    """The dataflow policies that are compared: one, or a list; a name alone is short for it."""
    seeds: Annotated[tuple[int, ...], parsed_by(_seeds), Expect(_SEEDS, _SEEDS_SCHEMA)] = (0,)
    """Seeds of the draws; `run` takes the first."""
    tolerance: Tolerance = None
    """`sweep` and `check` add seeds until the 95 % intervals of both profits are within this share
    of the mean, for each policy; at least 8 seeds, those given first."""
    max_seeds: Annotated[int, *integer(8, 100_000, "seeds")] = 64
    """Seeds at most per point with a tolerance."""
    refine: Switch = False
    """`sweep` and `check` add points along axes of `memory.fraction` and of whole numbers where
    lines between the profits would be off by more than the tolerance."""
    method: Annotated[str, *one_of(*METHODS)] = SIMULATE
    """Simulation, or the paper's analytical model of object and ray dataflow (`sweep`, `check` and
    `model`)."""
    engine: Annotated[str, *one_of(*ENGINES)] = DEFAULT_ENGINE
    """Event loop: compiled, or the readable one in SimPy."""
    sweep: Annotated[dict[str, list[object]], parsed_by(_axes), Expect(_AXES)] = Field(default={})
    """Values of dotted keys, such as memory.fraction: [0.1, 0.5, 1]."""
    check: CheckSettings = CheckSettings()
    """Tolerances of `simmpp check` against its baseline."""
    advise: AdviseSettings | None = None
    """The question of `simmpp advise`: goal, numbers of nodes, candidates."""

    @model_validator(mode="after")
    def _one_thing_is_asked(self) -> Settings:
        given = [key for key in ASKED if key in self.model_fields_set and getattr(self, key)]
        kind, asks = self.scene.kind
        for key in given:
            if key not in asks:
                raise mistake(f"{key} goes with {ASKED[key]}, not with scene.{kind}")
        if len(given) > 1:
            raise mistake(f"expected one of {', '.join(ASKED)}, got {' and '.join(given)}")
        return self

    @model_validator(mode="after")
    def _seeds_can_be_added(self) -> Settings:
        if self.tolerance is None:
            for key in ("max_seeds", "refine"):
                if key in self.model_fields_set and getattr(self, key):
                    raise mistake(f"{key} goes with a tolerance: expected a key tolerance as well")
        elif len(self.seeds) > self.max_seeds:
            raise mistake(f"max_seeds is {self.max_seeds}, and {len(self.seeds)} seeds are given")
        return self

    @field_validator("policy")
    @classmethod
    def _titles_differ(cls, policies: tuple[PolicyParameters, ...]) -> tuple[PolicyParameters, ...]:
        titles = [policy.title for policy in policies]
        if not titles:
            raise mistake("expected at least one policy")
        for policy in policies:
            if titles.count(policy.title) > 1:
                raise mistake(f"two are called {policy.title!r}: expected a label for each")
            if policy.title in POLICIES and policy.title != policy.name:
                raise mistake(f"label {policy.title!r} is the name of another policy")
        return policies
