"""What a policy is: a few hooks, and what it says about when and with what they are asked.

A hook is a plain function of a :class:`~simmpp.policy.view.View`. The oracle of the tests calls it
as it is; the engines call it compiled, by its address: a new or changed policy needs no other code
to be compiled again. One that a policy does not have costs nothing.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeVar, get_args

from simmpp.common.errors import ConfigError
from simmpp.common.units import shown
from simmpp.policy.view import NUMBERS, WORDS, View

NAME = re.compile(r"[^\W\d_][\w.+-]*")
"""Names of policies stand in sentences, columns and names of files."""
Hook = Callable[[View], int]
"""What it returns says the field of Policy that holds it."""
Packing = Literal["none", "requests", "all"]
"""What goes to one PE at one dispatch in one message: nothing, its requests, or everything."""
Steal = Literal["none", "half"]
"""How many of the pixels that it has not started a PE gives to one that holds no ray."""
Candidates = Literal["owner", "holders"]
HOOKS = ("send", "ask", "keep", "heard", "idle")
Function = TypeVar("Function", bound=Callable[..., object])


@dataclass(frozen=True, eq=False)
class Policy:
    """A policy; of its hooks None is one that it does not have."""

    name: str
    source: str = "one's own"
    """Where the policy is described."""
    send: Hook | None = None
    """How many of the rays that wait may go to one PE now: 0 for none, ``v.waiting`` for all. The
    engine takes the rays of whole objects, of those first that became sendable first, until it has
    so many or more; True is 1."""
    ask: Hook | None = None
    """May one object, for which rays wait, be asked for now? 0 no, 1 its owner, 2 + PE that PE,
    where the object is in memory for good; the owner if it isn't."""
    keep: Hook | None = None
    """What is a fetched object worth that no ray needs at once any more? 0 or less: nothing, it
    goes; else its rank in the memory for fetched objects, where the least rank leaves first, of
    equal ones the least recently used. Without this hook all are equal. What has just come leaves
    last."""
    heard: Hook | None = None
    """A message of the policy's own has come, its words in ``v.words``, from ``v.other``. Above 0:
    it is answered, with the words that the hook leaves in ``v.words``; else not."""
    idle: Hook | None = None
    """The PE has nothing to do and is about to sleep. When is it to be woken, if no message comes
    before? 0 or less: never; else the time (``v.now_ps`` + so many). Then it decides again, as at
    the end of an activity, and this is asked anew. ``v.other = k`` sends ``v.words`` to PE k."""
    batch: int | str = 1
    """``send`` is asked when that many rays wait, or nothing else is to do: a count, or the name of
    a number. So an engine need not look at every PE again and again."""
    ask_at_least: int | str = 1
    """The same of ``ask``."""
    candidates: Candidates = "owner"
    """Where rays may go: the owner of the object that they need next; or all PEs that have it in
    memory for good, asked about by the least known load, equal ones in ring order."""
    like: str = ""
    """A policy of the package: what a reading sets for it holds for this one too, as far as it can,
    so that the two can be compared."""
    parameters: Mapping[str, int] = field(default_factory=dict)
    """Numbers of its own, at most 8, with what they are unless users set them. Hooks read the first
    as ``v.parameter[0]`` or by its name."""
    all_resident: bool = False
    """Every object is in the memory of every PE."""

    def __post_init__(self) -> None:
        if not (isinstance(self.name, str) and NAME.fullmatch(self.name)):
            expected = "expected a letter, then letters, digits and any of _ . + -"
            raise ConfigError(f"policy: name: value {shown(self.name)}: {expected}")
        for what, function in self.hooks.items():
            _require_hook(f"policy {self.name!r}: {what}", function)
        _require_numbers(self.name, self.parameters)
        _require_counts(self)
        if self.candidates not in get_args(Candidates):
            expected = f"value {shown(self.candidates)}: expected owner or holders"
            raise ConfigError(f"policy {self.name!r}: candidates: {expected}")

    @property
    def hooks(self) -> dict[str, Hook]:
        """Those that it has, by what they are asked."""
        of_all = {what: getattr(self, what) for what in HOOKS}
        return {what: function for what, function in of_all.items() if function is not None}

    @property
    def sends(self) -> bool:
        """The policy has a hook that sends rays."""
        return self.send is not None

    @property
    def asks(self) -> bool:
        """The policy has a hook that asks for objects."""
        return self.ask is not None

    @property
    def talks(self) -> bool:
        """The policy may send messages of its own."""
        return self.idle is not None or self.heard is not None

    @property
    def to_holders(self) -> bool:
        """Rays may go to any PE that holds what they need."""
        return self.sends and self.candidates == "holders"

    @property
    def counts(self) -> tuple[int | str, int | str]:
        """How many rays have to wait for the hooks to be asked."""
        return (self.batch if self.sends else 1, self.ask_at_least if self.asks else 1)

    @property
    def packings(self) -> tuple[Packing, ...]:
        """What the policy may pack: its requests, and rays with them if it sends any."""
        if not self.asks:
            return ("none",)
        return ("none", "requests", "all") if self.sends else ("none", "requests")


def hook(function: Function) -> Function:
    """Mark a function as a hook; it stays as it is.

    Raises ConfigError if it is not a function of one argument, the view.
    """
    _require_hook("hook", function)
    return function


def _require_hook(where: str, function: object) -> None:
    if inspect.isfunction(function) and function.__code__.co_argcount == 1:
        return
    name = getattr(function, "__name__", shown(function))
    raise ConfigError(f"{where}: value {name}: expected a function of one argument, the view")


def _require_counts(policy: Policy) -> None:
    names = (*NUMBERS, *policy.parameters)
    for what, count in (("batch", policy.batch), ("ask_at_least", policy.ask_at_least)):
        if count in names or (type(count) is int and count >= 1):
            continue
        expected = f"expected a count from 1 on, or one of {', '.join(names)}"
        raise ConfigError(f"policy {policy.name!r}: {what}: value {shown(count)}: {expected}")


def _require_numbers(name: str, numbers: Mapping[str, int]) -> None:
    where = f"policy {name!r}: parameters"
    if len(numbers) > WORDS:
        raise ConfigError(f"{where}: {len(numbers)} of them: expected at most {WORDS}")
    for key, number in numbers.items():
        if not key.isidentifier() or key in View.__annotations__:
            raise ConfigError(
                f"{where}: value {key!r}: expected a name that the view does not have"
            )
        if type(number) is not int or not -(1 << 63) <= number < 1 << 63:
            raise ConfigError(f"{where}: {key}: value {shown(number)}: expected a 64-bit integer")
