"""The keys of a configuration: what each means, takes and defaults to."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated

from pydantic import Field, field_validator, model_validator

from simmpp.common.errors import ConfigError
from simmpp.common.strict import (
    Expect,
    Share,
    Size,
    Strict,
    Switch,
    Text,
    integer,
    mistake,
    one_of,
    parsed_by,
)
from simmpp.common.units import shown
from simmpp.config import values
from simmpp.engine.simulate import DEFAULT_ENGINE, ENGINES, READY_ORDERS
from simmpp.machine.constants import MOST_PROCESSORS, Constants
from simmpp.machine.presets import preset_names
from simmpp.methods.table import METHODS, SIMULATE
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.registry import DEFAULT_POLICY, POLICIES
from simmpp.workload.sources import SceneKey

Processors = Annotated[int, *integer(1, MOST_PROCESSORS)]
RayCount = Annotated[int, *integer(1, values.MOST_RAYS)]

MinLoad = Annotated[Fraction | int, parsed_by(values.min_load), Expect(values.MIN_LOAD)]
Information = Annotated[str | dict[str, int], parsed_by(values.load_info), Expect(values.LOAD_INFO)]
Tolerance = Annotated[Fraction | None, parsed_by(values.tolerance), Expect(values.TOLERANCE)]


class PictureSettings(Strict):
    """Rays that are traced."""

    resolution: Annotated[int, *integer(1, 16384)] = Field(
        default=512, description="pixels along each side"
    )
    samples: Annotated[str, *one_of("centres", "corners")] = Field(
        default="centres",
        description="a ray per pixel centre, or per corner (the SPD's rules)",
    )
    max_depth: Annotated[int, *integer(1, 100)] = Field(
        default=5,
        description="depth of the deepest ray that is not a shadow ray; the eye ray has depth 1",
    )
    shadows: Switch = Field(default=True, description="trace shadow rays")
    reflection: Switch = Field(default=True, description="trace reflected rays")
    refraction: Switch = Field(default=True, description="trace refracted rays")


class MachineSettings(Constants):
    """The simulated machine: a preset, and any of its constants overridden."""

    preset: Annotated[str, *one_of(*preset_names())] = Field(
        default="t3e", description="a machine of the package (see `simmpp machine PRESET`)"
    )


class MemorySettings(Strict):
    """What fits into the memory of one PE."""

    fraction: Share = Field(
        default=Fraction(1, 10), description="share x of all objects that is resident on each PE"
    )
    bytes: Size | None = Field(
        default=None, description="the other way to say it: room for resident objects"
    )
    residents: Annotated[str, *one_of("random", "nearest", "hot")] = Field(
        default="random", description="which objects are resident besides a PE's own"
    )
    transient: Annotated[int, *integer(0, values.MOST_RAYS)] = Field(
        default=0, description="fetched objects kept besides (least recently used leaves)"
    )

    @model_validator(mode="after")
    def _one_size(self) -> MemorySettings:
        if self.bytes is not None and "fraction" in self.model_fields_set:
            raise mistake("expected fraction or bytes, got both")
        return self


class PlacementSettings(Strict):
    """Who owns objects and who starts with which pixels."""

    owners: Annotated[str, *one_of("bisection", "morton", "round_robin", "random")] = Field(
        default="bisection", description="how objects are dealt to their owners"
    )
    pixels: Annotated[str, *one_of("blocks", "tiles", "interleaved", "random")] = Field(
        default="blocks", description="how pixels are dealt to the PEs that start them"
    )


POLICY = f"{', '.join(list(POLICIES)[:-1])} or {list(POLICIES)[-1]}, or a mapping"
_DEFAULTS = PolicyParameters(DEFAULT_POLICY)


class PolicySettings(Strict):
    """One policy. Its name alone is short for it; a list of either compares them."""

    name: Annotated[str, *one_of(*POLICIES)] = Field(
        default=DEFAULT_POLICY, description="the dataflow"
    )
    label: Text | None = Field(
        default=None, description="name in tables and rows; the policy's name when not given"
    )
    min_load: MinLoad = Field(
        default=_DEFAULTS.min_load, description="load above which rays may be sent (concurrent)"
    )
    batch: RayCount = Field(
        default=_DEFAULTS.batch, description="rays for one owner that are sent together"
    )
    ask_at_least: RayCount = Field(
        default=_DEFAULTS.ask_at_least,
        description="rays waiting for an object before it is asked for (concurrent)",
    )
    load_info: Information = Field(
        default="piggyback", description="how a PE knows the load of others"
    )
    merge_requests: Switch = Field(
        default=_DEFAULTS.merge_requests, description="one request per missing object in flight"
    )

    @property
    def title(self) -> str:
        """The label, or the name where none was given."""
        return self.label or self.name


def long_policies(value: object) -> list[object]:
    """One policy is a list of one, and a name alone a mapping."""
    entries = value if isinstance(value, list | tuple) else [value]
    return [{"name": entry} if isinstance(entry, str) else entry for entry in entries]


def policies(value: object) -> object:
    """The same, once each entry is found to be a name or a mapping."""
    entries = long_policies(value)
    for entry in entries:
        if not isinstance(entry, dict):
            raise ConfigError(f"value {shown(entry)}: expected {POLICY}")
    return entries


class CheckSettings(Strict):
    """What `simmpp check` allows; without any of these, every integer must be the baseline's."""

    time_profit: Tolerance = Field(
        default=None, description="relative change of the time profit that `check` allows"
    )
    message_profit: Tolerance = Field(
        default=None, description="likewise of the message profit; what isn't named isn't compared"
    )
    speedup: Tolerance = Field(default=None, description="likewise of the speedup")
    efficiency: Tolerance = Field(default=None, description="likewise of the efficiency")

    @property
    def tolerances(self) -> dict[str, Fraction]:
        """Relative change allowed of each profit named."""
        return {name: share for name, share in self if share is not None}


class Settings(Strict):
    """A whole configuration."""

    scene: SceneKey = Field(description="what is rendered")
    picture: PictureSettings = Field(default=PictureSettings(), description="rays that are traced")
    machine: MachineSettings = Field(default=MachineSettings(), description="what computes it")
    processors: Processors = Field(default=64, description="number of PEs, nb in the paper")
    memory: MemorySettings = Field(default=MemorySettings(), description="memory of one PE")
    placement: PlacementSettings = Field(
        default=PlacementSettings(), description="where objects and pixels are"
    )
    ready_order: Annotated[str, *one_of(*READY_ORDERS)] = Field(
        default="depth-first", description="new ready rays go to the front, or to the back"
    )
    policy: Annotated[tuple[PolicySettings, ...], parsed_by(policies)] = Field(
        default=(PolicySettings(),), description="the dataflow policies that are compared"
    )
    seeds: Annotated[tuple[int, ...], parsed_by(values.seeds), Expect(values.SEEDS)] = Field(
        default=(0,), description="seeds of the draws; `run` takes the first"
    )
    tolerance: Tolerance = Field(
        default=None,
        description="`sweep` and `check` add seeds until the 95 % intervals of both profits are "
        "within this share of the mean, for each policy; at least 8 seeds, those given first",
    )
    max_seeds: Annotated[int, *integer(8, 100_000)] = Field(
        default=64, description="seeds at most per point with a tolerance"
    )
    refine: Switch = Field(
        default=False,
        description="`sweep` and `check` add points along axes of `memory.fraction` and of whole "
        "numbers where lines between the profits would be off by more than the tolerance",
    )
    method: Annotated[str, *one_of(*METHODS)] = Field(
        default=SIMULATE,
        description="simulation, or the paper's analytical model of object and ray dataflow "
        "(`sweep`, `check` and `model`)",
    )
    engine: Annotated[str, *one_of(*ENGINES)] = Field(
        default=DEFAULT_ENGINE, description="event loop: compiled, or the readable one in SimPy"
    )
    sweep: Annotated[dict[str, list[object]], parsed_by(values.axes), Expect(values.AXES)] = Field(
        default={}, description="values of dotted keys, such as memory.fraction: [0.1, 0.5, 1]"
    )

    check: CheckSettings = Field(
        default=CheckSettings(), description="tolerances of `simmpp check` against its baseline"
    )

    @model_validator(mode="after")
    def _picture_is_traced(self) -> Settings:
        if self.scene.source.scene is None and "picture" in self.model_fields_set:
            raise mistake("picture goes with a scene that is traced, not with scene.workload")
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
    def _titles_differ(cls, policies: tuple[PolicySettings, ...]) -> tuple[PolicySettings, ...]:
        titles = [policy.title for policy in policies]
        if not titles:
            raise mistake("expected at least one policy")
        for policy in policies:
            if titles.count(policy.title) > 1:
                raise mistake(f"two are called {policy.title!r}: expected a label for each")
            if policy.title in POLICIES and policy.title != policy.name:
                raise mistake(f"label {policy.title!r} is the name of another policy")
        return policies
