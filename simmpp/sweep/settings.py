"""The keys of a configuration: what each means, takes and defaults to."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Annotated

from pydantic import Field, ValidationInfo, field_validator, model_validator

from simmpp.engine.simulate import ENGINES, READY_ORDERS
from simmpp.errors import ConfigError
from simmpp.machine.constants import MOST_PROCESSORS, Constants
from simmpp.machine.presets import preset_names
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.table import POLICIES
from simmpp.scene.spd.generators import find_generator, known_names
from simmpp.strict import (
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
from simmpp.sweep import values

Processors = Annotated[int, *integer(1, MOST_PROCESSORS)]
RayCount = Annotated[int, *integer(1, values.MOST_RAYS)]

Objects = Annotated[str | dict[str, int], parsed_by(values.objects), Expect(values.OBJECTS)]
MinLoad = Annotated[Fraction | int, parsed_by(values.min_load), Expect(values.MIN_LOAD)]
Information = Annotated[str | dict[str, int], parsed_by(values.load_info), Expect(values.LOAD_INFO)]
Tolerance = Annotated[Fraction | None, parsed_by(values.tolerance), Expect(values.TOLERANCE)]


class SceneSettings(Strict):
    """What is rendered: one of spd, nff, mesh. Text such as ``mountain:5`` is short for it."""

    spd: Annotated[str, *one_of(*known_names())] | None = Field(
        default=None, description="a scene of the Standard Procedural Databases (Haines 1987)"
    )
    size: Annotated[int, *integer(1, 10**9)] | None = Field(
        default=None, description="size of that scene; the SPD's own when not given"
    )
    nff: Text | None = Field(
        default=None, description="an NFF file, relative to the configuration's folder"
    )
    mesh: Text | None = Field(
        default=None, description="a mesh file that trimesh reads (OBJ, PLY, STL, GLB ...)"
    )
    objects: Objects | None = Field(
        default=None, description="how a mesh is cut into objects; components when not given"
    )

    @field_validator("size")
    @classmethod
    def _size_exists(cls, size: int | None, others: ValidationInfo) -> int | None:
        name = others.data.get("spd")
        if size is not None and name is not None:
            try:
                find_generator(name).check(size)
            except ConfigError as error:
                raise mistake(f"value {size}: {error.problem}") from None
        return size

    @model_validator(mode="after")
    def _one_source(self) -> SceneSettings:
        given = [key for key in ("spd", "nff", "mesh") if getattr(self, key) is not None]
        if len(given) != 1:
            problem = f"expected one of spd, nff, mesh, got {' and '.join(given) or 'none'}"
        elif self.size is not None and given != ["spd"]:
            problem = "size goes with spd only"
        elif self.objects is not None and given != ["mesh"]:
            problem = "objects goes with mesh only"
        else:
            return self
        raise mistake(problem)


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
        default=5, description="depth of the deepest ray; the eye ray has depth 1"
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


_DEFAULTS = PolicyParameters("concurrent")


class PolicySettings(Strict):
    """One policy. Its name alone is short for it; a list of either compares them."""

    name: Annotated[str, *one_of(*POLICIES)] = Field(
        default="concurrent", description="the dataflow"
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


def long_policies(value: object) -> object:
    """One policy is a list of one, and a name alone a mapping."""
    entries = value if isinstance(value, list | tuple) else [value]
    return [{"name": entry} if isinstance(entry, str) else entry for entry in entries]


def long_scene(value: object) -> object:
    """``mountain:5`` or a file's name as the mapping it is short for."""
    if not isinstance(value, str):
        return value
    name, colon, detail = value.rpartition(":")
    number = int(detail) if re.fullmatch("[0-9]{1,9}", detail) else None
    if value in known_names():
        return {"spd": value}
    if name in known_names():
        return {"spd": name, "size": detail if number is None else number}
    if number is not None:
        return {"mesh": name, "objects": {"clusters": number}}
    if detail in ("nodes", "components") and colon:
        return {"mesh": name, "objects": detail}
    return {"nff" if value.lower().endswith(".nff") else "mesh": value}


class Settings(Strict):
    """A whole configuration."""

    scene: Annotated[SceneSettings, parsed_by(long_scene)] = Field(description="what is rendered")
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
    policy: Annotated[tuple[PolicySettings, ...], parsed_by(long_policies)] = Field(
        default=(PolicySettings(),), description="the dataflow policies that are compared"
    )
    seeds: Annotated[tuple[int, ...], parsed_by(values.seeds), Expect(values.SEEDS)] = Field(
        default=(0,), description="seeds of the draws; `run` takes the first"
    )
    tolerance: Tolerance = Field(
        default=None, description="seeds are added until both profits are known this well"
    )
    max_seeds: Annotated[int, *integer(8, 100_000)] = Field(
        default=64, description="seeds at most per point with a tolerance"
    )
    method: Annotated[str, *one_of("simulate", "analytical", "analytical-measured")] = Field(
        default="simulate", description="simulation, or the paper's analytical model"
    )
    engine: Annotated[str, *one_of(*ENGINES)] = Field(
        default="simpy", description="event loop of the simulation"
    )
    sweep: Annotated[dict[str, list[object]], parsed_by(values.axes), Expect(values.AXES)] = Field(
        default={}, description="values of dotted keys, such as memory.fraction: [0.1, 0.5, 1]"
    )

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
