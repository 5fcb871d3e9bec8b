"""How old loads may be: sampled at once they are exact, never again they are those of the start."""

from __future__ import annotations

from dataclasses import replace

import pytest
from builders import Case, random_case
from implementations import run

from simmpp.common.errors import ConfigError
from simmpp.engine.simulate import ENGINES
from simmpp.policy.parameters import POLICIES, PolicyParameters
from simmpp.policy.policy import Policy
from simmpp.policy.view import View


def with_info(seed: int, load_info: object) -> Case:
    case = random_case(seed)
    names = ("concurrent", "holders")
    policy = PolicyParameters(
        names[seed % 2],
        min_load=0,
        batch=2,
        ask_at_least=3,
        load_info=load_info,  # type: ignore[arg-type]
    )
    return replace(case, policy=policy)


@pytest.mark.parametrize("engine", ENGINES)
def test_sampled_all_the_time_is_exact(engine: str) -> None:
    moved = 0
    for seed in range(40):
        exact = run(engine, with_info(seed, "exact"))
        assert run(engine, with_info(seed, {"sampled": 0})) == exact
        moved += run(engine, with_info(seed, {"sampled": "never"})) != exact
    assert moved > 0


def of_the_start(v: View) -> int:
    v.memory[0] += v.known_load != v.initial_load
    v.memory[1] += v.age_ps != v.now_ps
    return v.waiting if v.memory[0] + v.memory[1] == 0 else 0


@pytest.mark.parametrize("implementation", ["oracle", *ENGINES])
def test_never_sampled_again_are_the_loads_of_the_start(
    implementation: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(POLICIES, "first", Policy("first", send=of_the_start))  # else it starves
    ran = 0
    for seed in range(60):
        case = with_info(seed, {"sampled": "never"})
        n0, nb = case.workload.n_primaries, case.machine.processors
        if n0 % nb:
            continue
        placement = replace(case.placement, pixel_pes=(case.placement.pixel_pes * 0).astype("i4"))
        placement.pixel_pes[:] = [k % nb for k in range(n0)]  # as many on each
        policy = replace(case.policy, name="first", batch=1)
        run(implementation, replace(case, placement=placement, policy=policy))
        ran += 1
    assert ran > 5


def test_periods_are_times_and_said_again_as_written() -> None:
    assert PolicyParameters(load_info={"sampled": "5 ms"}).sample_ps == 5 * 10**9
    for wrong in ({"sampled": "x"}, {"sampled": -1}, "sampled", {"sampled": None}):
        with pytest.raises(ConfigError):
            PolicyParameters(load_info=wrong)  # type: ignore[arg-type]
