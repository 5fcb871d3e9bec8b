"""Rules that no one would want: every run ends, and is the oracle's run.

Each rule is plain Python, compiled for the engines and called as it is by the oracle.
SIMMPP_TEST_CASES says how many random machines each pair of rules meets (40 if unset).
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import asdict, replace
from math import floor

import pytest
from builders import Case, random_case
from implementations import run
from oracles.rules import Rules, View

from simmpp.common.errors import ModelError
from simmpp.engine.simulate import ENGINES
from simmpp.policy.registry import POLICIES
from simmpp.policy.rules import DataflowPolicy, ask_rule, send_rule

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "40"))

SendRule = Callable[[int, int, int, int, int, int], bool]
AskRule = Callable[[int, int, int], bool]


def at_a_whim(
    load: int, known_load: int, age_ps: int, waiting: int, nothing_else: int, min_load: int
) -> bool:
    return (7 * load + 13 * known_load + age_ps // 3 + 5 * waiting + min_load) % 3 != 0


def to_the_more_loaded(
    load: int, known_load: int, age_ps: int, waiting: int, nothing_else: int, min_load: int
) -> bool:
    return known_load >= load


def on_old_news(
    load: int, known_load: int, age_ps: int, waiting: int, nothing_else: int, min_load: int
) -> bool:
    return age_ps > 100 * waiting


def never_while_busy(
    load: int, known_load: int, age_ps: int, waiting: int, nothing_else: int, min_load: int
) -> bool:
    return nothing_else != 0


def at_odd_counts(load: int, waiting: int, nothing_else: int) -> bool:
    return nothing_else != 0 or (load + waiting) % 2 == 1


def only_when_idle(load: int, waiting: int, nothing_else: int) -> bool:
    return nothing_else != 0


def no(load: int, waiting: int, nothing_else: int) -> bool:
    return load < 0


PAIRS: list[tuple[SendRule, AskRule]] = [
    (send, ask)
    for send in (at_a_whim, to_the_more_loaded, on_old_news, never_while_busy)
    for ask in (at_odd_counts, only_when_idle)
]


def compiled(send: SendRule, ask: AskRule) -> DataflowPolicy:
    """The rules as a policy of the package."""
    return DataflowPolicy("adversary", "none", send_rule(send), ask_rule(ask), knows_loads=True)


def plain(send: SendRule, ask: AskRule) -> Rules:
    """The rules as the oracle calls them: with whole numbers, -1 for a load not known."""

    def may_send(view: View) -> bool:
        known = -1 if view.known_load is None else floor(view.known_load)
        minimum = floor(view.min_load)
        return send(view.load, known, view.age_ps, view.waiting, int(view.nothing_else), minimum)

    def may_ask(view: View) -> bool:
        return ask(view.load, view.waiting, int(view.nothing_else))

    return Rules(may_send, may_ask, knows_loads=True)


def adversarial_case(seed: int) -> Case:
    case = random_case(seed)
    return replace(case, policy=replace(case.policy, name="adversary"))


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("send", "ask"), PAIRS)
def test_every_integer_is_the_oracles(
    engine: str, send: SendRule, ask: AskRule, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(POLICIES, "adversary", compiled(send, ask))
    for seed in range(CASES):
        case = adversarial_case(seed)
        expected = asdict(run("oracle", case, plain(send, ask)))
        got = asdict(run(engine, case))
        for name in expected:
            assert got[name] == expected[name], f"seed {seed}: {name} under {case.policy}"
        assert got["rays_sent"] + got["messages_by_kind"][1] <= got["tests"]


@pytest.mark.parametrize("engine", ENGINES)
def test_rules_that_starve_a_ray_are_told_so(engine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(POLICIES, "adversary", compiled(to_the_more_loaded, no))
    with pytest.raises(ModelError, match="rays are left and nothing is scheduled"):
        for seed in range(10):
            run(engine, adversarial_case(seed))
