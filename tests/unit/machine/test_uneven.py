"""Factors of PEs and of noise: what can be written, and what it means."""

from __future__ import annotations

import math
from fractions import Fraction
from statistics import NormalDist, fmean, stdev

import pytest
from by_hand import OBJECT, case_of
from hypothesis import given
from hypothesis import strategies as st

import simmpp
from simmpp.common.errors import ConfigError
from simmpp.config.config import config_from_mapping
from simmpp.engine.pe.pace import scaled
from simmpp.machine.machine import Machine
from simmpp.machine.noise import _QUANTILES, DRAWS, ONE, factors
from simmpp.machine.presets import OVERRIDDEN, machine
from simmpp.machine.uneven import Straggler, bound_of, factor, speeds_of, total_speed
from simmpp.model.known import require_known

EMPTY = case_of(OBJECT, [], owners=(), object_bytes=())


@pytest.mark.parametrize("noise", ["1/100", "1/20", "1/3", "1"])
def test_factors_are_lognormal_with_a_mean_of_one(noise: str) -> None:
    found, sigma = factors(noise), float(Fraction(noise))
    assert len(found) == DRAWS and list(found) == sorted(found)
    assert abs(fmean(found) / ONE - 1) < 1e-7
    logarithms = [math.log(each / ONE) for each in found]
    assert stdev(logarithms) == pytest.approx(sigma, rel=0.01)
    exact = [math.exp(sigma * z / 10**4) for z in (*(-z for z in _QUANTILES[::-1]), *_QUANTILES)]
    assert all(abs(a - ONE * b / fmean(exact)) < 1 for a, b in zip(found, exact, strict=True))


def test_no_noise_is_the_factor_one() -> None:
    assert set(factors("0")) == {ONE}


def test_quantiles_are_the_normal_distributions() -> None:
    exact = [NormalDist().inv_cdf((n + 0.5) / 256) for n in range(128, 256)]
    assert list(_QUANTILES) == [round(10**4 * z) for z in exact]


@given(
    number=st.integers(0, 2**62),
    times=st.integers(1, 2**31),
    per=st.integers(1, 2**31),
)
def test_scaled_is_exact(number: int, times: int, per: int) -> None:
    exact = math.floor(Fraction(number * times, per) + Fraction(1, 2))
    if exact < 2**62:
        assert scaled.py_func(number, times, per) == exact


def test_speeds_by_number_and_by_share() -> None:
    of_some = (("0-2", "2"), ("5", "1/2"))
    assert speeds_of(of_some, 6) == [2, 2, 2, 1, 1, Fraction(1, 2)]
    assert total_speed(of_some, 6) == Fraction(17, 2)
    assert bound_of(17, of_some, 6) == 2 and bound_of(18, of_some, 6) == 3
    in_turn = (("25%", "2"), ("50%", "3"))
    assert speeds_of(in_turn, 4) == [2, 3, 3, 1]
    assert speeds_of(in_turn, 2) == [2, 3]  # half of one is one, 1.5 are two
    assert speeds_of(in_turn, 1) == [3]
    assert total_speed((), 7) == 7


@pytest.mark.parametrize(
    ("written", "text"),
    [
        (2, "2"),
        (0.5, "1/2"),
        ("1/3", "1/3"),
        (" 10 / 4", "5/2"),
        ("1e3", "1000"),
        (0.001, "1/1000"),
    ],
)
def test_factors_are_exact(written: object, text: str) -> None:
    assert factor(written) == text


@pytest.mark.parametrize("wrong", [0, -1, True, None, "x", "1/0", 1001, 0.0001, "1.00001", [2], {}])
def test_no_factors(wrong: object) -> None:
    with pytest.raises(ConfigError, match=r"expected a factor such as 2, 0\.5 or 1/3"):
        factor(wrong)


def made(**overrides: object) -> Machine:
    return machine("t3e", overrides, processors=8)


def test_a_machine_with_all_of_it() -> None:
    straggler = {"pe": 7, "factor": 3, "from": "1 s", "to": "2 s"}
    found = made(speed={"0-3": 2, 7: 0.5}, noise="5%", straggler=straggler)
    assert found.speed == (("0-3", "2"), ("7", "1/2")) and found.noise == "1/20"
    assert found.straggler == Straggler(7, "3", 10**12, 2 * 10**12)
    assert found.is_uneven and not made().is_uneven
    assert found.sources["speed"] == found.sources["noise"] == OVERRIDDEN
    assert made(compute_startup="1 us").is_uneven and made(least_tests=9).is_uneven


def config(machine: dict[str, object], **keys: object) -> dict[str, object]:
    here = {"scene": "tetra:2", "picture": {"resolution": 8}, "processors": 4, "policy": "object"}
    return {**here, "machine": machine, **keys}


def test_rows_tell_the_bound_and_seeds_draw_noise() -> None:
    keys = {"reading": "plain", "seeds": [0, 1], "memory": {"fraction": 1}}
    noisy = simmpp.sweep(config({"noise": "20%", "speed": {"50%": 2}}, **keys)).rows
    assert (noisy.bound_ps * 6 - noisy.work_ps).between(0, 5).all() and noisy.work_ps.nunique() == 1
    assert noisy.makespan_ps.nunique() == 2 and (noisy.launch_ps == 0).all()
    plain = simmpp.sweep(config({}, **keys)).rows
    assert plain.makespan_ps.nunique() == 1 and "work_ps" not in plain


@pytest.mark.parametrize("key", ["compute_startup", "least_tests", "speed", "noise", "straggler"])
def test_the_papers_model_knows_none_of_it(key: str) -> None:
    values = {"compute_startup": "1 us", "least_tests": 2, "speed": {0: 2}, "noise": "5%"}
    machine = {key: values.get(key, {"factor": 2})}
    with pytest.raises(ConfigError, match=r"expected simulate where a machine has compute_startup"):
        config_from_mapping(config(machine, method="analytical"))
    with pytest.raises(ConfigError, match=r"^machine: the paper's analytical model knows tests"):
        require_known(made(**machine), EMPTY.workload)


@pytest.mark.parametrize(
    ("overrides", "line"),
    [
        ({"speed": {"0-9": 2}}, "speed: PE 9: expected 0 to 7"),
        ({"speed": {"0-3": 2, 2: 3}}, "speed: PE 2 is in two of them"),
        ({"speed": {"3-0": 2}}, "speed: PEs '3-0': expected the lower number first"),
        ({"speed": {"80%": 2, "30%": 3}}, "speed: shares of more than 100 % of the PEs"),
        ({"speed": {"25%": 2, 1: 3}}, "speed: expected PEs, or shares of them, but not both"),
        ({"speed": {"PE 1": 2}}, "speed: PEs 'PE1': expected a number, 0-3, or a share such as"),
        ({"speed": 2}, "speed: value 2: expected factors of PEs, such as {0-3: 2, 7: 1/2}"),
        ({"speed": {}}, "speed: value {}: expected factors of PEs"),
        ({"noise": "120%"}, "noise: value '120%': expected a share from 0 to 1"),
        ({"straggler": {"pe": 8, "factor": 2}}, "straggler.pe: value 8: expected a PE from 0 to"),
        ({"straggler": {"pe": 1}}, "straggler: missing key 'factor'"),
        ({"straggler": {"factor": "1/2"}}, "straggler.factor: value 1/2: expected at least 1"),
        (
            {"straggler": {"factor": 2, "from": "2 s", "to": "1 s"}},
            "straggler.to: expected a time after `from`",
        ),
        ({"straggler": {"factor": 2, "until": "1 s"}}, "straggler: unknown key 'until'"),
    ],
)
def test_what_can_not_be_is_one_line(overrides: dict[str, object], line: str) -> None:
    with pytest.raises(ConfigError) as refused:
        made(**overrides)
    assert str(refused.value).startswith(line)
