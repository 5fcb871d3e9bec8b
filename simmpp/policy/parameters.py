"""What a user sets of a policy: its name, the numbers that its hooks read, and what it is told."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import (
    AliasPath,
    Field,
    SerializerFunctionWrapHandler,
    ValidationInfo,
    field_validator,
    model_serializer,
    model_validator,
)
from pydantic.json_schema import SkipJsonSchema
from pydantic_core import ArgsKwargs

from simmpp.common.errors import ConfigError
from simmpp.common.places import unknown
from simmpp.common.quantities import Time
from simmpp.common.strict import (
    Switch,
    Text,
    declared,
    in_words,
    mistake,
    parsed_by,
)
from simmpp.common.units import shown
from simmpp.policy.file import PolicyFile, digest_of, policy_of_file
from simmpp.policy.mistakes import unknown_like
from simmpp.policy.policy import Packing, Policy, Steal
from simmpp.policy.reads import knows_loads
from simmpp.policy.table import CEILING as CEILING
from simmpp.policy.table import CLASSICAL as CLASSICAL
from simmpp.policy.table import DEFAULT_POLICY as DEFAULT_POLICY
from simmpp.policy.table import POLICIES as POLICIES
from simmpp.policy.table import REFERENCE as REFERENCE
from simmpp.policy.written import NAME as NAME
from simmpp.policy.written import (
    NEVER,
    NEVER_PS,
    KnownLoads,
    LoadInfo,
    MinLoad,
    OwnName,
    OwnNumbers,
    OwnPolicy,
    PolicyName,
    RayCount,
    own_policy,
    parse_period,
)


@declared
class PolicyParameters:
    """One policy of a run. A rule that a policy does not have ignores its parameters."""

    name: PolicyName = DEFAULT_POLICY
    """The dataflow."""
    label: Text | None = None
    """Name in tables and rows; the policy's name when not given."""
    min_load: MinLoad = Fraction(12, 100)
    """The paper's minimal load, above which rays may be sent (concurrent)."""
    batch: RayCount = 256
    """Rays for one owner that are sent together, unless there is nothing else to do."""
    ask_at_least: RayCount = 32
    """The paper's sufficient count: rays waiting for an object before it is asked for
    (concurrent)."""
    load_info: KnownLoads = "piggyback"
    """How a PE knows the load of others: from headers (the paper), exactly, or not at all; with
    `refresh`, its own load is also sent to peers that were sent nothing for that long; `sampled`:
    all know all loads as they were at the last multiple of that time (or `never` but at the
    start); `two`: exactly, but a policy with several candidates looks at two at random only."""
    refresh_ps: Annotated[
        SkipJsonSchema[Time | None], Field(validation_alias=AliasPath("load_info", "refresh"))
    ] = None
    """That time. Policies whose send rule reads no load ignore it, as they ignore load_info."""
    sample_ps: Annotated[
        SkipJsonSchema[int | None],
        parsed_by(parse_period),
        Field(validation_alias=AliasPath("load_info", "sampled"), validate_default=True),
    ] = None
    """With load_info sampled: the time between two samples of all loads."""
    merge_requests: Switch = True
    """One request per missing object in flight; false sends one request per waiting ray."""
    packing: Packing = "none"
    """What goes to one PE at one dispatch in one message: nothing, its requests (and the answers to
    them), or all, rays with requests (the mixed dataflow of Nebel 1997)."""

    steal: Steal = "none"
    """With `half`, a PE that holds no ray asks others for pixels that they have not started, the
    most loaded it knows of first, each once; that gives half of them, its last ones."""

    file: OwnPolicy = None
    """A policy of one's own in place of a `name`: a Python file with `POLICY = Policy(...)`, which
    is run (see `simmpp policy`)."""
    set: OwnNumbers = None
    """The policy's own numbers that are not to be what its file says."""

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
            sample_ps: int | str | None = ...,
            merge_requests: bool = ...,
            packing: Packing = ...,
            steal: Steal = ...,
            file: str | PolicyFile | Policy | None = ...,
            set: dict[str, int | str] | None = ...,
        ) -> None: ...

    @model_validator(mode="before")
    @classmethod
    def _named_by_its_file(cls, given: Any) -> Any:
        """A policy of one's own says its name itself."""
        keys = (given.kwargs or {}) if isinstance(given, ArgsKwargs) else given
        if not isinstance(keys, dict) or keys.get("file") is None:
            return given
        try:
            own = own_policy(keys["file"])
        except ConfigError:  # told by the field
            return given
        policy = _policy(own)
        if keys.get("name", policy.name) != policy.name or policy.name in POLICIES:
            return given
        named = {**keys, "file": own, "name": OwnName(policy.name)}
        return ArgsKwargs(given.args, named) if isinstance(given, ArgsKwargs) else named

    @field_validator("sample_ps")
    @classmethod
    def _has_a_period(cls, sample_ps: int | None, others: ValidationInfo) -> int | None:
        if (sample_ps is None) == (others.data.get("load_info") == "sampled"):
            raise mistake("load_info: expected a period with sampled, such as {sampled: 5 ms}")
        return sample_ps

    @field_validator("packing")
    @classmethod
    def _can_pack(cls, packing: Packing, others: ValidationInfo) -> Packing:
        policy = POLICIES.get(others.data.get("name", ""))
        if policy is not None:
            _refuse_packing(packing, policy)
        return packing

    @field_validator("file")
    @classmethod
    def _alone(cls, file: PolicyFile | Policy | None, others: ValidationInfo) -> Any:
        if file is not None and (name := _policy(file).name) != others.data.get("name"):
            if name in POLICIES:
                raise mistake(f"its policy is called {name!r}: expected no name of the package's")
            raise mistake(f"its policy is called {name!r}: expected no other name beside it")
        if file is not None and (problem := unknown_like(_policy(file))):
            raise mistake(problem)
        if file is not None and "packing" in others.data:
            _refuse_packing(others.data["packing"], _policy(file))
        return file

    @field_validator("set")
    @classmethod
    def _are_its_own(cls, numbers: Any, others: ValidationInfo) -> Any:
        own = others.data.get("file")
        known = _policy(own).parameters if own else {}
        for name, _ in numbers or ():
            if name not in known:
                has_none = f"{others.data.get('name')} has no numbers of its own"
                raise mistake(unknown(name, sorted(known)) if known else has_none)
        return numbers

    @property
    def rules(self) -> Policy:
        """The policy itself."""
        return POLICIES[self.name] if self.file is None else _policy(self.file)

    @property
    def numbers(self) -> tuple[int, ...]:
        """Its own numbers, in their order."""
        return tuple({**self.rules.parameters, **dict(self.set or ())}.values())

    @property
    def packs(self) -> bool:
        """Several things may share a message."""
        return self.packing != "none"

    @property
    def steals(self) -> bool:
        """PEs that hold no ray ask others for pixels."""
        return self.steal != "none"

    @property
    def rests(self) -> bool:
        """PEs that have nothing to do may have something to say."""
        return self.rules.idle is not None or self.steals

    @property
    def knows_loads(self) -> bool:
        """Loads of others decide what it does."""
        return knows_loads(self.rules) or self.steals

    @property
    def uses(self) -> tuple[str, ...]:
        """What has columns of its own in a table of results, where anything makes use of it."""
        uses = {"packs": self.packs, "talks": self.rules.talks, "steals": self.steals}
        return tuple(use for use, it_does in uses.items() if it_does)

    @property
    def title(self) -> str:
        """The label, or the name where none was given."""
        return self.label or self.name

    @model_serializer(mode="wrap")
    def _as_written(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        plain: dict[str, Any] = handler(self)
        if refresh := plain.pop("refresh_ps", None):
            plain["load_info"] = {"refresh": refresh}
        if (period := plain.pop("sample_ps", None)) is not None:
            plain["load_info"] = {"sampled": NEVER if period == NEVER_PS else f"{period} ps"}
        if not self.steals:
            del plain["steal"]
        return {key: plain[key] for key in plain if key not in ("file", "set")} | self.own

    @property
    def own(self) -> dict[str, Any]:
        """What is to be known of a policy of one's own: where it is from, and its digest."""
        if self.file is None:
            return {}
        numbers = dict(zip(self.rules.parameters, self.numbers, strict=True))
        path, digest = "(an object of Python)", ""
        if isinstance(self.file, PolicyFile):
            path, digest = self.file.path, self.file.digest
        return {"file": path, "digest": digest or digest_of(self.rules), "set": numbers}


def _refuse_packing(packing: Packing, policy: Policy) -> None:
    if packing not in policy.packings:
        expected = f"{in_words(policy.packings)} for {policy.name}"
        raise mistake(f"value {shown(packing)}: expected {expected}")


def _policy(own: Any) -> Policy:
    """The policy of a file, or itself."""
    return policy_of_file(own) if isinstance(own, PolicyFile) else own


def policy_of(
    policy: PolicyParameters | Policy | str, argument: str = "policy"
) -> PolicyParameters:
    """The policy, or the one of that name with its defaults, as Python callers pass either.

    Raises ConfigError, which names the argument, for what is none.
    """
    if isinstance(policy, PolicyParameters):
        return policy
    if isinstance(policy, Policy):
        return PolicyParameters(file=policy)
    if not isinstance(policy, str) or policy not in POLICIES:
        expected = f"{in_words(tuple(POLICIES))}, or PolicyParameters"
        raise ConfigError(f"{argument}: value {shown(policy)}: expected {expected}")
    return PolicyParameters(policy)
