"""The policies, and what a user sets of one: its name and the numbers that its hooks read.

A further policy is a file like ``concurrent``, a line in POLICIES, and a field of PolicyParameters
for each number of its own.
"""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args

from pydantic import (
    AliasPath,
    Field,
    SerializerFunctionWrapHandler,
    ValidationInfo,
    field_validator,
    model_serializer,
)
from pydantic.json_schema import SkipJsonSchema

from simmpp.common.errors import ConfigError
from simmpp.common.quantities import TIME, Time
from simmpp.common.strict import (
    Expect,
    Short,
    Switch,
    Text,
    declared,
    in_words,
    integer,
    mistake,
    only,
    parsed_by,
)
from simmpp.common.units import picoseconds, share, shown
from simmpp.common.validate import MOST_COUNT, whole
from simmpp.policy.concurrent import CONCURRENT_DATAFLOW
from simmpp.policy.object_dataflow import OBJECT_DATAFLOW
from simmpp.policy.policy import Packing, Policy
from simmpp.policy.ray_dataflow import RAY_DATAFLOW
from simmpp.policy.replicated import REPLICATED

POLICIES: dict[str, Policy] = {
    "object": OBJECT_DATAFLOW,
    "ray": RAY_DATAFLOW,
    "concurrent": CONCURRENT_DATAFLOW,
    "replicated": REPLICATED,
}
REFERENCE, CEILING = "object", "replicated"
"""Run with every point: what profits are measured against, and no dataflow at all."""
CLASSICAL = ("object", "ray")
"""The dataflows that the paper joins; the faster of them is what a further one has to beat."""
DEFAULT_POLICY = "concurrent"
"""What a configuration that names none compares with object dataflow."""

LoadInfo = Literal["piggyback", "exact", "none"]

_LOAD_INFO = "piggyback, exact, none or {refresh: 5 ms}"
_MIN_LOAD = "a share of n0 / nb such as 12%, or a number of rays"


def _min_load(value: object) -> Fraction | int:
    """A share of n0 / nb (Fraction) or a number of rays (int), as users write it."""
    if isinstance(value, Fraction) or (isinstance(value, str) and set("%/") & set(value)):
        return share(value)
    return _load(value, _MIN_LOAD)


def _load(
    value: object, expected: str = f"a Fraction or an integer from 0 to {MOST_COUNT}"
) -> Fraction | int:
    """The same, as Python may pass it."""
    try:
        if isinstance(value, Fraction) and 0 <= value <= MOST_COUNT:
            return value
        return whole(value, 0, MOST_COUNT)
    except ConfigError:
        raise ConfigError(f"value {shown(value)}: expected {expected}") from None


def _load_info(value: object) -> object:
    """One of the words; ``{refresh: 5 ms}`` is piggyback, and sets ``refresh_ps`` as well."""
    if isinstance(value, dict) and set(value) == {"refresh"}:
        with suppress(ConfigError):
            picoseconds(value["refresh"])
            return "piggyback"
    if not isinstance(value, str) or value not in get_args(LoadInfo):
        raise ConfigError(f"value {shown(value)}: expected {_LOAD_INFO}")
    return value


NAME = Short(in_words(tuple(POLICIES)), {"enum": list(POLICIES)})
"""A policy's name alone is short for it."""
_RAYS = {"type": "integer", "minimum": 0, "maximum": MOST_COUNT}
_MIN_LOAD_SCHEMA = {"anyOf": [_RAYS, {"type": "string", "pattern": "[%/]"}]}
_REFRESH_SCHEMA = {
    "type": "object",
    "properties": {"refresh": TIME},
    "required": ["refresh"],
    "additionalProperties": False,
}
_NAMES = only(
    lambda name: isinstance(name, str) and name in POLICIES,  # as it is then: Python may add some
    Expect(in_words(tuple(POLICIES)), {"enum": list(POLICIES)}),
)
RayCount = Annotated[int, *integer(1, MOST_COUNT, "rays")]


@declared
class PolicyParameters:
    """One policy of a run. A rule that a policy does not have ignores its parameters."""

    name: Annotated[str, *_NAMES] = DEFAULT_POLICY
    """The dataflow."""
    label: Text | None = None
    """Name in tables and rows; the policy's name when not given."""
    min_load: Annotated[
        Fraction | int,
        parsed_by(_min_load, _load),
        Expect(_MIN_LOAD, _MIN_LOAD_SCHEMA, "% or rays"),
    ] = Fraction(12, 100)
    """The paper's minimal load, above which rays may be sent (concurrent)."""
    batch: RayCount = 256
    """Rays for one owner that are sent together, unless there is nothing else to do."""
    ask_at_least: RayCount = 32
    """The paper's sufficient count: rays waiting for an object before it is asked for
    (concurrent)."""
    load_info: Annotated[
        LoadInfo,
        parsed_by(_load_info),
        Expect(_LOAD_INFO, {"anyOf": [{"enum": list(get_args(LoadInfo))}, _REFRESH_SCHEMA]}),
    ] = "piggyback"
    """How a PE knows the load of others: from headers (the paper), exactly, or not at all; with
    `refresh`, its own load is also sent to peers that were sent nothing for that long."""
    refresh_ps: Annotated[
        SkipJsonSchema[Time | None], Field(validation_alias=AliasPath("load_info", "refresh"))
    ] = None
    """That time. Policies whose send rule reads no load ignore it, as they ignore load_info."""
    merge_requests: Switch = True
    """One request per missing object in flight; false sends one request per waiting ray."""
    packing: Packing = "none"
    """What goes to one PE at one dispatch in one message: nothing, its requests (and the answers to
    them), or all, rays with requests (the mixed dataflow of Nebel 1997)."""

    if TYPE_CHECKING:  # arguments take more than fields hold

        def __init__(
            self,
            name: str = ...,
            label: str | None = ...,
            min_load: Fraction | int | str = ...,
            batch: int = ...,
            ask_at_least: int = ...,
            load_info: LoadInfo | dict[str, str] = ...,
            refresh_ps: int | str | None = ...,
            merge_requests: bool = ...,
            packing: Packing = ...,
        ) -> None: ...

    @field_validator("packing")
    @classmethod
    def _can_pack(cls, packing: Packing, others: ValidationInfo) -> Packing:
        policy = POLICIES.get(others.data.get("name", ""))
        if policy is not None and packing not in policy.packings:
            expected = f"{in_words(policy.packings)} for {policy.name}"
            raise mistake(f"value {shown(packing)}: expected {expected}")
        return packing

    @property
    def rules(self) -> Policy:
        """The policy itself."""
        return POLICIES[self.name]

    @property
    def numbers(self) -> tuple[int, ...]:
        """Its own numbers, in their order."""
        return tuple(self.rules.parameters.values())

    @property
    def packs(self) -> bool:
        """Several things may share a message."""
        return self.packing != "none"

    @property
    def title(self) -> str:
        """The label, or the name where none was given."""
        return self.label or self.name

    @model_serializer(mode="wrap")
    def _as_written(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        plain: dict[str, Any] = handler(self)
        if refresh := plain.pop("refresh_ps", None):
            plain["load_info"] = {"refresh": refresh}
        return plain


def policy_of(policy: PolicyParameters | str, argument: str = "policy") -> PolicyParameters:
    """The policy, or the one of that name with its defaults, as Python callers pass either.

    Raises ConfigError, which names the argument, for what is none.
    """
    if isinstance(policy, PolicyParameters):
        return policy
    if not isinstance(policy, str) or policy not in POLICIES:
        expected = f"{in_words(tuple(POLICIES))}, or PolicyParameters"
        raise ConfigError(f"{argument}: value {shown(policy)}: expected {expected}")
    return PolicyParameters(policy)
