"""Hooks that no one would want: every run ends, and is the oracle's run.

Each hook is plain Python, compiled for the engines and called as it is by the oracle.
SIMMPP_TEST_CASES says how many random machines each pair of hooks meets (40 if unset).
"""

from __future__ import annotations

import os
from dataclasses import asdict, replace
from typing import get_args

import pytest
from builders import Case, random_case, some_stealing, with_capacity
from implementations import run

from simmpp.common.errors import ModelError
from simmpp.engine.simulate import ENGINES
from simmpp.machine.messages import OBJECT
from simmpp.placement.rooms import LEAST
from simmpp.policy.parameters import POLICIES
from simmpp.policy.policy import Candidates, Hook, Policy
from simmpp.policy.view import View

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "40"))


def at_a_whim(v: View) -> int:
    mood = 7 * v.load + 13 * v.known_load + v.age_ps // 3 + 5 * v.waiting + v.min_load
    return v.waiting if mood % 3 != 0 else 0


def to_the_more_loaded(v: View) -> int:
    return v.waiting * (v.known_load >= v.load)


def on_old_news(v: View) -> bool:
    return v.age_ps > 100 * v.waiting


def never_while_busy(v: View) -> int:
    return -5 if v.nothing_else == 0 else 1000


def far_or_near(v: View) -> int:
    return v.waiting if (v.hops + v.waiting) % 2 == 0 or v.batch % 3 == 0 else 1


def by_all_that_it_sees(v: View) -> int:
    v.memory[1] += v.waiting
    v.memory[2] = v.now_ps
    costs = v.send_ps + v.receive_ps + v.flight_ps + v.held_bytes
    seen = v.me + v.nb + v.ready + v.other + v.in_flight + v.initial_load + v.memory[1]
    done = v.finished + v.busy_ps - v.compute_ps * 2 + v.fetched - v.released
    costs += v.fetch_ps * v.objects - v.fetch_flight_ps + done + v.speed - v.other_speed
    nothing = v.object + v.owner + v.object_bytes + v.test_ps + v.holders + v.requests + v.unasked
    return (costs + seen + v.parameter[1] * v.greed) % (v.waiting + 2) if nothing == -2 else 0


def by_chance(v: View) -> int:
    v.memory[0] += 1
    return v.random % (v.waiting + 3) - v.memory[0] % 2


def at_odd_counts(v: View) -> bool:
    return v.nothing_else != 0 or (v.load + v.waiting + v.hops) % 2 == 1


def only_when_idle(v: View) -> int:
    return v.nothing_else


def of_whom_it_likes(v: View) -> int:
    seen = v.object + v.object_bytes + v.owner + v.requests + v.in_flight + v.known_load + v.load
    costs = v.send_ps + v.receive_ps + v.flight_ps + v.test_ps + v.age_ps
    costs += v.fetch_ps // 3 + v.fetch_flight_ps // 5 - v.objects + v.finished * v.released
    costs += 2 * v.speed + 3 * v.other_speed
    v.memory[7] = (v.memory[7] * 3 + seen + costs - v.unasked * v.holders) % 1000003
    return v.memory[7] % (v.nb + 4) + v.nothing_else


def of_anyone(v: View) -> int:
    return v.random % (v.nb + 2) + 1


def what_it_fancies(v: View) -> int:
    v.memory[5] += v.held_bytes + v.unasked
    seen = v.object_bytes + v.now_ps + v.holders + v.nothing_else + v.known_load + v.waiting
    seen += v.busy_ps + v.finished + v.fetched * v.released + v.fetch_ps
    return (seen + v.memory[5] + v.random % 1009) % 5 - 1  # 64 bits hold it


def no(v: View) -> bool:
    return v.load < 0


SENDS = (at_a_whim, to_the_more_loaded, on_old_news, never_while_busy, far_or_near)
PAIRS = [(send, ask) for send in SENDS for ask in (at_odd_counts, only_when_idle)]
PAIRS += [(by_all_that_it_sees, of_whom_it_likes), (by_chance, of_whom_it_likes)]
PAIRS += [(by_all_that_it_sees, of_anyone), (by_chance, of_anyone)]
COUNTS = (("batch", "ask_at_least"), (1, 1), (3, "greed"))
"""From how many waiting rays on the two hooks are asked."""


def adversary(
    send: Hook,
    ask: Hook,
    batch: int | str,
    ask_at_least: int | str,
    candidates: Candidates = "owner",
) -> Policy:
    """The hooks as a policy of the package."""
    return Policy(
        "adversary",
        "none",
        send,
        ask,
        batch=batch,
        ask_at_least=ask_at_least,
        candidates=candidates,
        keep=what_it_fancies if batch != 1 else None,
        parameters={"greed": 2, "envy": -7},
    )


def adversarial_case(seed: int) -> Case:
    case = some_stealing(random_case(seed), seed)
    packing = POLICIES["adversary"].packings[seed % 3]
    if seed % 4 == 1:
        case = replace(case, placement=replace(case.placement, transient_bytes=700 * seed))
    return replace(case, policy=replace(case.policy, name="adversary", packing=packing))


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("send", "ask"), PAIRS)
@pytest.mark.parametrize("counts", COUNTS)
@pytest.mark.parametrize("candidates", get_args(Candidates))
def test_every_integer_is_the_oracles(
    engine: str,
    send: Hook,
    ask: Hook,
    counts: tuple[int | str, int | str],
    candidates: Candidates,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    policy = adversary(send, ask, *counts, candidates)
    monkeypatch.setitem(POLICIES, "adversary", policy)
    for seed in range(CASES if counts == COUNTS[0] else CASES // 4):
        case = adversarial_case(seed)
        expected, got = asdict(run("oracle", case)), asdict(run(engine, case))
        for name in expected:
            assert got[name] == expected[name], f"seed {seed}: {name} under {case.policy}"
        assert got["rays_sent"] + got["parts_by_kind"][OBJECT] <= got["tests"]


@pytest.mark.parametrize(("send", "ask"), [*PAIRS[::3], PAIRS[-1], (to_the_more_loaded, no)])
@pytest.mark.parametrize("candidates", get_args(Candidates))
def test_in_the_least_memory_all_of_them_end(
    send: Hook, ask: Hook, candidates: Candidates, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With packing, refresh and evictions, and as the oracle says."""
    monkeypatch.setitem(POLICIES, "adversary", adversary(send, ask, 3, "greed", candidates))
    for seed in range(CASES // 5):
        least = {"bytes": LEAST} if seed % 2 else {}
        case = with_capacity(adversarial_case(seed), seed, flow="credits", **least)
        expected, got = asdict(run("oracle", case)), asdict(run("compiled", case))
        for name in expected:
            assert got[name] == expected[name], f"seed {seed}: {name} under {case.policy}"
        assert got["rays"] == case.workload.n_rays


@pytest.mark.parametrize("engine", ENGINES)
def test_hooks_that_starve_a_ray_are_told_so(engine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(POLICIES, "adversary", adversary(to_the_more_loaded, no, 1, 1))
    with pytest.raises(ModelError, match="rays are left and nothing is scheduled"):
        for seed in range(10):
            run(engine, adversarial_case(seed))
