"""What the built-in hooks say, by conditions written down apart; compiled they say the same."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from fractions import Fraction
from itertools import product
from types import SimpleNamespace
from typing import Any, cast, get_args

import numba
import numpy as np
import pytest

import simmpp
from simmpp.common.errors import ConfigError
from simmpp.machine.machine import SERVICES, TOPOLOGY_NAMES
from simmpp.policy import Policy, hook
from simmpp.policy.hooks import address_of
from simmpp.policy.parameters import POLICIES, PolicyParameters
from simmpp.policy.plain import uncompiled
from simmpp.policy.reads import groups_read, names_in, reads
from simmpp.policy.record import VIEW
from simmpp.policy.view import GROUPS, LOADS, NUMBERS, OBJECT, RANDOM, SELF, WAY, View
from simmpp.policy.written import LoadInfo
from simmpp.studies.policies.machines import random_case as random_machine

MIN_LOAD = 2
REST = {"min_load": MIN_LOAD, "in_flight": 1}
WAY_PS = {"send_ps": 4, "receive_ps": 6, "flight_ps": 5, "fetch_ps": 14, "fetch_flight_ps": 11}
REST |= WAY_PS | {"test_ps": 3, "finished": 0, "compute_ps": 0, "unasked": 4, "nothing_else": 0}
NAMES = ("load", "waiting", "known_load")
SEEN = [
    dict(zip(NAMES, values, strict=True))
    for values in product((0, 2, 3, 9), (1, 2, 3, 4, 5), (-1, 2, 3, 8))
]
Answer = Callable[[Any], int]

SENDS: dict[str, Answer] = {
    "ray": lambda v: int(v.waiting),
    "concurrent": lambda v: int(v.waiting) * (v.load > MIN_LOAD and v.load > v.known_load),
    "holders": lambda v: int(max(0, v.load - v.known_load - 1) // 2) * (v.load > MIN_LOAD),
    "cost": lambda v: int(v.waiting) * (25 // v.waiting > 15 // v.waiting),
}
ASKS: dict[str, Answer] = dict.fromkeys(("object", "concurrent", "holders", "cost"), lambda v: 1)
COUNTS = {
    "object": (1, 1),
    "ray": ("batch", 1),
    "concurrent": ("batch", "ask_at_least"),
    "replicated": (1, 1),
    "holders": ("batch", "ask_at_least"),
    "cost": ("batch", "ask_at_least"),
}


def view(**seen: int) -> View:
    return cast(View, SimpleNamespace(memory=[0] * 8, **seen, **REST))


def compiled(hook: Any, names: tuple[str, ...] = (), **shown: Any) -> int:
    """What the machine code of a hook says."""
    record = np.zeros(1, VIEW)
    for name, value in shown.items():
        record[name] = value
    code = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)(address_of(hook, names))
    return int(code(record.ctypes.data))


@pytest.mark.parametrize("name", POLICIES)
def test_hooks_say_what_their_names_promise(name: str) -> None:
    policy = POLICIES[name]
    for function, answer in ((policy.send, SENDS), (policy.ask, ASKS)):
        assert (function is not None) == (name in answer)
        for seen in SEEN if function is not None else ():
            expected = answer[name](view(**seen))
            assert function is not None
            assert function(view(**seen)) == expected, seen
            assert compiled(function, **seen, **REST) == expected, seen
    assert policy.counts == COUNTS[name]


def test_costs_are_weighed_with_what_a_ray_has_taken_of_late() -> None:
    send, ask = POLICIES["cost"].send, POLICIES["cost"].ask
    assert send is not None and ask is not None
    seen = REST | {"load": 20, "known_load": 5, "in_flight": 1, "waiting": 4}
    memory = [0] * 8
    # 10 ps a ray, then 10 + (26 - 10) / 8; 14 rays more than the other, 6 - 3 ps a ray to fetch.
    for finished, compute_ps, enough in ((10, 100, 143 // 20), (18, 308, 171 // 24)):
        seen |= {"finished": finished, "compute_ps": compute_ps}
        before, shown = memory.copy(), SimpleNamespace(memory=memory, **seen)
        assert send(cast(View, shown)) == compiled(send, memory=before, **seen) == enough
    assert memory[:3] == [12, 18, 308]
    assert send(cast(View, SimpleNamespace(memory=memory, **seen | {"load": 6}))) == 1
    assert send(cast(View, SimpleNamespace(memory=memory, **seen | {"load": 5}))) == 0
    for nothing_else, unasked, answer in ((0, 3, 0), (0, 4, 1), (1, 1, 1)):
        seen |= {"nothing_else": nothing_else, "unasked": unasked}
        assert ask(cast(View, SimpleNamespace(**seen))) == compiled(ask, **seen) == answer


def test_the_view_has_all_numbers_of_a_policy_and_no_field_in_two_groups() -> None:
    values = vars(PolicyParameters("object"))
    assert tuple(n for n, value in values.items() if type(value) in (int, Fraction)) == NUMBERS
    assert VIEW.names == (*View.__annotations__,)
    fields = [name for names in GROUPS.values() for name in names]
    assert len(set(fields)) == len(fields)
    assert set(fields) < set(VIEW.names or ())


@hook
def by_number(v: View) -> int:
    v.memory[3] += v.parameter[1]
    return v.second * 10 + v.memory[3]


def test_numbers_of_its_own_have_names_and_memory_is_written() -> None:
    assert compiled(by_number, ("first", "second"), parameter=[4, 5, *[0] * 6]) == 55


@numba.njit
def helper(v: View) -> int:
    return v.known_load


def calls_another(v: View) -> int:
    return helper(v) + v.hops


def in_a_lambda(v: View) -> int:
    return (lambda: v.random)()


def test_what_a_hook_reads_is_found_where_it_calls_another() -> None:
    assert names_in(calls_another) >= {"known_load", "hops"}
    assert compiled(calls_another, known_load=3, hops=4) == 7
    assert groups_read(calls_another) == LOADS | WAY
    assert uncompiled(calls_another)(cast(View, SimpleNamespace(known_load=3, hops=4))) == 7
    assert groups_read(in_a_lambda) == RANDOM
    assert groups_read(None) == groups_read(POLICIES["ray"].send) == 0
    assert groups_read(lambda v: v.object + v.now_ps) == OBJECT | SELF
    assert reads(POLICIES["concurrent"], "known_load")
    assert not reads(POLICIES["concurrent"], "hops")


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"send": 3}, "send: value 3: expected a function of one argument"),
        ({"ask": lambda: 1}, "expected a function of one argument"),
        ({"parameters": {"a b": 1}}, "expected a name that the view does not have"),
        ({"parameters": {"load": 1}}, "expected a name that the view does not have"),
        ({"parameters": {"x": 1.5}}, "x: value 1.5: expected a 64-bit integer"),
        ({"parameters": {"x": 1 << 63}}, "expected a 64-bit integer"),
        ({"parameters": {f"x{n}": n for n in range(9)}}, "9 of them: expected at most 8"),
    ],
)
def test_what_is_no_policy_is_refused(changes: dict[str, Any], expected: str) -> None:
    with pytest.raises(ConfigError, match=expected):
        Policy("own", **changes)


def test_who_is_like_a_policy_names_one() -> None:
    assert PolicyParameters(file=Policy("own", ask=lambda v: 1, like="concurrent")).name == "own"
    for wrong in ("own", "concurent", 3, None, []):
        with pytest.raises(ConfigError, match=r"like: value .*: expected object, ray"):
            PolicyParameters(file=Policy("own", ask=lambda v: 1, like=wrong))  # type: ignore[arg-type]
    assert {policy.like for policy in POLICIES.values()} <= {"", *POLICIES}


def test_an_object_of_python_is_swept_in_this_process_alone() -> None:
    own = Policy("own", send=lambda v: v.waiting, ask=lambda v: 1)
    config = {"scene": "tetra:2", "picture": {"resolution": 8}, "processors": 2}
    config["policy"] = ["object", own]
    rows = simmpp.sweep(config).rows
    assert set(rows["policy"]) == {"object", "own"}
    assert rows["error"].isna().all()
    with pytest.raises(ConfigError, match="policy 'own' is an object of Python"):
        simmpp.sweep(config, workers=2)


def tell_the_next(v: View) -> int:
    v.other = (v.me + 1) % v.nb
    return 0


def test_messages_of_its_own_have_columns_where_a_policy_sends_any() -> None:
    own = Policy("talks", ask=lambda v: 1, idle=tell_the_next)
    config = {"scene": "tetra:2", "picture": {"resolution": 8}, "processors": 4}
    rows = simmpp.sweep(config | {"policy": ["object", own], "memory": {"fraction": 1}}).rows
    said = dict(zip(rows["policy"], rows["user_messages"], strict=True))
    assert said["object"] == 0 < said["talks"]
    assert set(rows["messages"] - rows["user_messages"]) == {0}
    assert "user_messages" not in simmpp.sweep(config | {"policy": "object"}).rows


def test_a_policy_is_checked_on_all_kinds_of_machines_and_all_ways_to_know_loads() -> None:
    found = [random_machine(PolicyParameters("holders"), seed) for seed in range(50)]
    assert {case.machine.topology for case in found} == set(TOPOLOGY_NAMES)
    assert {case.machine.service for case in found} == set(SERVICES)
    assert {case.policy.load_info for case in found} == set(get_args(LoadInfo))
    assert {case.policy.refresh_ps for case in found} == {None, 10**6}
