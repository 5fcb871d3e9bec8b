"""What the built-in rules say, by conditions written down apart; compiled they say the same."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from itertools import product
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from simmpp.policy.compiled_rules import NUMBERS, VIEW, address_of
from simmpp.policy.parameters import POLICIES
from simmpp.policy.rules import DataflowPolicy
from simmpp.policy.view import View

BATCH, SUFFICIENT, MIN_LOAD = 4, 3, 2
NAMES = ("load", "waiting", "nothing_else", "known_load")
SEEN = [
    dict(zip(NAMES, values, strict=True))
    for values in product((0, 2, 3, 9), (1, 2, 3, 4, 5), (0, 1), (-1, 2, 3, 8))
]
Condition = Callable[[Any], bool]

SENDS: dict[str, Condition] = {
    "ray": lambda v: v.waiting >= BATCH or v.nothing_else == 1,
    "concurrent": lambda v: (
        (v.waiting >= BATCH or v.nothing_else == 1) and v.load > MIN_LOAD and v.load > v.known_load
    ),
}
ASKS: dict[str, Condition] = {
    "object": lambda v: True,
    "concurrent": lambda v: v.waiting >= SUFFICIENT or v.nothing_else == 1,
}


def view(seen: dict[str, int]) -> View:
    own = {"batch": BATCH, "ask_at_least": SUFFICIENT, "min_load": MIN_LOAD}
    return cast(View, SimpleNamespace(**seen, **own, age_ps=0, hops=0))


def compiled(rule: Any, shown: View) -> int:
    """What the machine code of a rule says."""
    record = np.zeros(1, VIEW)
    for name in VIEW.names or ():
        record[name] = getattr(shown, name)
    code = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)(address_of(rule))
    return int(code(record.ctypes.data))


@pytest.mark.parametrize("name", POLICIES)
def test_rules_say_what_their_names_promise(name: str) -> None:
    policy = POLICIES[name]
    for rule, condition in ((policy.may_send, SENDS), (policy.may_ask, ASKS)):
        assert (rule is not None) == (name in condition)
        for seen in SEEN if rule is not None else ():
            expected = condition[name](view(seen))
            assert bool(rule and rule(view(seen))) == expected, seen
            assert bool(compiled(rule, view(seen))) == expected, seen


@pytest.mark.parametrize("policy", POLICIES.values(), ids=POLICIES)
def test_no_rule_says_yes_where_it_is_not_asked(policy: DataflowPolicy) -> None:
    """Below the declared number, as long as there is anything else to do."""
    for rule, least in ((policy.may_send, policy.send_from), (policy.may_ask, policy.ask_from)):
        for shown in map(view, SEEN) if rule is not None else ():
            enough = least if isinstance(least, int) else getattr(shown, least)
            assert shown.waiting >= enough or shown.nothing_else or not (rule and rule(shown))


def test_the_view_has_all_numbers_of_a_policy() -> None:
    assert NUMBERS == ("min_load", "batch", "ask_at_least")
    assert VIEW.names == (*View.__annotations__, *NUMBERS)
