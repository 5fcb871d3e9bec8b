"""What a policy is: a send rule and an ask rule, and what they have to know.

A rule is a plain function of a :class:`~simmpp.policy.view.View` that says yes or no. The oracle
of the tests calls it as it is; the engines call it compiled, by its address: a new or changed
policy needs no other code to be compiled again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from simmpp.policy.view import View

Rule = Callable[[View], int]
"""True or 1: yes."""
Packing = Literal["none", "requests", "all"]
"""What goes to one PE at one dispatch in one message: nothing, its requests, or everything."""


@dataclass(frozen=True)
class DataflowPolicy:
    """Two rules; None is one that the policy does not have."""

    name: str
    source: str
    """Where the policy is described."""
    may_send: Rule | None = None
    """May the rays waiting for objects of one owner be sent to it now?"""
    may_ask: Rule | None = None
    """May one object, for which rays wait, be asked for now?"""
    send_from: int | str = 1
    """The send rule says no for fewer waiting rays than that, unless there is nothing else to do:
    a count, or the name of a parameter. Only then is it asked at all, so an engine need not look
    at every owner again and again."""
    ask_from: int | str = 1
    """The same of the ask rule."""
    knows_loads: bool = False
    """The send rule reads the other PE's load; without, headers are not remembered."""
    knows_hops: bool = False
    """A rule reads the distance to the owner."""
    all_resident: bool = False
    """Every object is in the memory of every PE."""

    @property
    def sends(self) -> bool:
        """The policy has a send rule."""
        return self.may_send is not None

    @property
    def asks(self) -> bool:
        """The policy has an ask rule."""
        return self.may_ask is not None

    @property
    def packings(self) -> tuple[Packing, ...]:
        """What the policy may pack: its requests, and rays with them if it sends any."""
        if not self.asks:
            return ("none",)
        return ("none", "requests", "all") if self.sends else ("none", "requests")
