"""What a policy is: a send rule, an ask rule, and how they are batched.

Rules are compiled apart, as C functions of one signature that the engines call by their address:
a new or changed policy needs no other code to be compiled again. They see only what a PE may know.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from simmpp.common.compiled import cfunc

SEND_RULE = types.int64(
    types.int64,  # load: rays this PE holds
    types.int64,  # known_load: load last heard of the owner; -1: not known (load_info none)
    types.int64,  # age_ps: time since that was heard (since the start if never, 0 if exact)
    types.int64,  # waiting: rays that wait for objects of the owner and may be sent
    types.int64,  # nothing_else: 1 if there is no ready ray and the inbox is empty
    types.int64,  # min_load: the paper's minimal load, in rays
)
ASK_RULE = types.int64(
    types.int64,  # load: rays this PE holds
    types.int64,  # waiting: rays that wait for the object and no request covers
    types.int64,  # nothing_else: 1 if there is no ready ray and the inbox is empty
)


@intrinsic
def allows(typing_context: Any, address: Any, arguments: Any) -> Any:
    """Call the rule at ``address`` with a tuple of int64 arguments; 0 means no.

    A rule passed as a first-class function would cost microseconds to unwrap at every call from
    Python, and one compiled into its caller would leave that caller's cache stale when it changes.
    """

    def call(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        word = ir.IntType(64)
        n = len(signature.args[1])
        pointer = builder.inttoptr(values[0], ir.FunctionType(word, [word] * n).as_pointer())
        return builder.call(pointer, [builder.extract_value(values[1], i) for i in range(n)])

    return types.int64(types.int64, types.UniTuple(types.int64, len(arguments))), call


def send_rule(rule: Callable[[int, int, int, int, int, int], bool]) -> Any:
    """Compile ``rule(load, known_load, age_ps, waiting, nothing_else, min_load)``."""
    return cfunc(SEND_RULE)(rule)


def ask_rule(rule: Callable[[int, int, int], bool]) -> Any:
    """Compile ``rule(load, waiting, nothing_else)``."""
    return cfunc(ASK_RULE)(rule)


@send_rule
def never_send(
    load: int, known_load: int, age_ps: int, waiting: int, nothing_else: int, min_load: int
) -> bool:
    """No ray ever leaves its PE."""
    return False


@ask_rule
def never_ask(load: int, waiting: int, nothing_else: int) -> bool:
    """No object is ever asked for."""
    return False


@dataclass(frozen=True)
class DataflowPolicy:
    """Two rules. Each is consulted only when a batch is full or there is nothing else to do."""

    name: str
    source: str
    """Where the policy is described."""
    may_send: Any = never_send
    """May the rays waiting for objects of one owner be sent to it now?"""
    may_ask: Any = never_ask
    """May one object, for which rays wait, be asked for now?"""
    ask_at_least: int | None = None
    """Fixed count of rays that makes an object worth asking for; None: the user's parameter."""
    knows_loads: bool = False
    """The send rule reads the other PE's load; without, headers are not remembered."""
    all_resident: bool = False
    """Every object is in the memory of every PE."""

    @property
    def sends(self) -> bool:
        """The policy has a send rule."""
        return self.may_send is not never_send

    @property
    def asks(self) -> bool:
        """The policy has an ask rule."""
        return self.may_ask is not never_ask
