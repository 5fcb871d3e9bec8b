"""Rules that no one would want: every run ends, and is the oracle's run.

Each rule is plain Python, compiled for the engines and called as it is by the oracle.
SIMMPP_TEST_CASES says how many random machines each pair of rules meets (40 if unset).
"""

from __future__ import annotations

import os
from dataclasses import asdict, replace
from math import floor
from types import SimpleNamespace
from typing import cast

import pytest
from builders import Case, random_case
from implementations import run

from simmpp.common.errors import ModelError
from simmpp.engine.simulate import ENGINES
from simmpp.machine.messages import OBJECT
from simmpp.policy.parameters import POLICIES
from simmpp.policy.rules import DataflowPolicy, Rule
from simmpp.policy.view import View

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "40"))


def at_a_whim(v: View) -> bool:
    return (7 * v.load + 13 * v.known_load + v.age_ps // 3 + 5 * v.waiting + v.min_load) % 3 != 0


def to_the_more_loaded(view: View) -> bool:
    return view.known_load >= view.load


def on_old_news(view: View) -> bool:
    return view.age_ps > 100 * view.waiting


def never_while_busy(view: View) -> bool:
    return view.nothing_else != 0


def far_or_near(view: View) -> bool:
    return (view.hops + view.waiting) % 2 == 0 or view.batch % 3 == 0


def at_odd_counts(view: View) -> bool:
    return view.nothing_else != 0 or (view.load + view.waiting + view.hops) % 2 == 1


def only_when_idle(view: View) -> bool:
    return view.nothing_else != 0


def no(view: View) -> bool:
    return view.load < 0


SENDS = (at_a_whim, to_the_more_loaded, on_old_news, never_while_busy, far_or_near)
PAIRS = [(send, ask) for send in SENDS for ask in (at_odd_counts, only_when_idle)]
FILTERS = (("batch", "ask_at_least"), (1, 1), (3, 2))
"""From how many waiting rays on the two rules are asked."""


def adversary(send: Rule, ask: Rule, send_from: int | str, ask_from: int | str) -> DataflowPolicy:
    """The rules as a policy of the package."""
    return DataflowPolicy(
        "adversary",
        "none",
        *(send, ask, send_from, ask_from),
        knows_loads=True,
        knows_hops=True,
    )


def plain(policy: DataflowPolicy) -> DataflowPolicy:
    """The rules as the oracle calls them: with whole numbers, and only where enough rays wait."""
    send, ask = policy.may_send, policy.may_ask
    assert send is not None and ask is not None
    return replace(
        policy,
        may_send=lambda view: _enough(view, policy.send_from) and send(_floors(view)),
        may_ask=lambda view: _enough(view, policy.ask_from) and ask(_floors(view)),
    )


def _enough(view: View, least: int | str) -> bool:
    count = least if isinstance(least, int) else getattr(view, least)
    return view.waiting >= count or bool(view.nothing_else)


def _floors(view: View) -> View:
    return cast(View, SimpleNamespace(**{name: floor(n) for name, n in vars(view).items()}))


def adversarial_case(seed: int) -> Case:
    case = random_case(seed)
    packing = POLICIES["adversary"].packings[seed % 3]
    return replace(case, policy=replace(case.policy, name="adversary", packing=packing))


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("send", "ask"), PAIRS)
@pytest.mark.parametrize("filters", FILTERS)
def test_every_integer_is_the_oracles(
    engine: str,
    send: Rule,
    ask: Rule,
    filters: tuple[int | str, int | str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    policy = adversary(send, ask, *filters)
    monkeypatch.setitem(POLICIES, "adversary", policy)
    for seed in range(CASES if filters == FILTERS[0] else CASES // 4):
        case = adversarial_case(seed)
        expected = asdict(run("oracle", case, plain(policy)))
        got = asdict(run(engine, case))
        for name in expected:
            assert got[name] == expected[name], f"seed {seed}: {name} under {case.policy}"
        assert got["rays_sent"] + got["parts_by_kind"][OBJECT] <= got["tests"]


@pytest.mark.parametrize("engine", ENGINES)
def test_rules_that_starve_a_ray_are_told_so(engine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(POLICIES, "adversary", adversary(to_the_more_loaded, no, 1, 1))
    with pytest.raises(ModelError, match="rays are left and nothing is scheduled"):
        for seed in range(10):
            run(engine, adversarial_case(seed))
