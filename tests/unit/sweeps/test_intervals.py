"""Intervals of means, and of logarithms: by Student's table."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simmpp.sweeps.intervals import of_logarithms

T_1 = 12.706204736174698
"""Student's t of 97.5 % with 1 degree of freedom (any table)."""


def test_two_draws_by_hand() -> None:
    found = of_logarithms([1.0, math.e**2])
    assert found == pytest.approx((math.e, math.exp(1 - T_1), math.exp(1 + T_1)))


@given(st.lists(st.floats(1e-9, 1e9), min_size=2, max_size=9))
def test_ends_are_positive_and_reciprocals_have_reciprocal_ends(values: list[float]) -> None:
    one, other = of_logarithms(values), of_logarithms([1 / value for value in values])
    assert 0 < one.low <= one.high
    assert one.mean * other.mean == pytest.approx(1)
    if one.high < math.exp(600):
        assert one.low * other.high == pytest.approx(1)


def test_equal_draws_are_their_mean_to_the_last_bit() -> None:
    assert of_logarithms([1.1, 1.1, 1.1]) == (1.1, 1.1, 1.1)


@pytest.mark.parametrize(
    ("values", "mean"),
    [([], math.nan), ([3.0], 3.0), ([0.0, 2.0], 0.0), ([2.0, math.inf], math.inf),
     ([0.0, math.inf], math.nan), ([0.0, 0.0], 0.0), ([math.inf] * 2, math.inf)],
)  # fmt: skip
def test_what_has_no_interval(values: list[float], mean: float) -> None:
    found = of_logarithms(values)
    assert found.mean == pytest.approx(mean, nan_ok=True)
    assert math.isnan(found.low) and math.isnan(found.high)


def test_draws_far_apart_have_finite_ends() -> None:
    assert math.isfinite(of_logarithms([1e-300, 1e300]).high)
