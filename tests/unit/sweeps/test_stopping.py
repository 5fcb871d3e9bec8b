"""How many seeds a point needs: their order, the looks, and intervals that hold their word."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from simmpp.common.validate import MOST_SEED
from simmpp.config.config import config_from_mapping
from simmpp.sweeps.intervals import half_width
from simmpp.sweeps.stopping import (
    CORRECTED,
    corrected_interval,
    first_seeds,
    seeds_in_order,
    seeds_wanted,
)

TWO_PERCENT = Fraction(1, 50)
values = st.lists(st.floats(0.5, 2), min_size=8, max_size=8)


def test_given_seeds_come_first_then_the_integers_that_follow() -> None:
    assert seeds_in_order([0], 4) == [0, 1, 2, 3]
    assert seeds_in_order([5, 3], 5) == [5, 3, 4, 6, 7]
    assert seeds_in_order([7, MOST_SEED], 4) == [7, MOST_SEED, 0, 1]


def test_a_point_begins_with_eight_seeds_or_all_that_are_given() -> None:
    def first(**more: object) -> list[int]:
        return first_seeds(config_from_mapping({"scene": "tetra:1", **more}).settings)

    assert first(seeds=[4]) == [4]
    assert first(seeds=[4], tolerance="2%") == [4, 5, 6, 7, 8, 9, 10, 11]
    assert first(seeds=list(range(9)), tolerance="2%") == list(range(9))


def test_the_next_look_is_where_a_fixed_number_would_do() -> None:
    wide = [0.9, 1.1] * 4  # deviation 0.10690, half-width t(0.9875, 7) 0.10690 / sqrt(8) = 0.10714
    assert half_width(wide, CORRECTED) == pytest.approx(
        stats.t.ppf(0.9875, 7) * np.std(wide, ddof=1) / math.sqrt(8)
    )
    assert seeds_wanted([wide], 8, Fraction(11, 100), 64) == 8
    assert seeds_wanted([wide], 8, Fraction(9, 100), 64) == 12  # 8 (10.714 / 9)^2 = 11.3
    assert seeds_wanted([wide], 8, Fraction(1, 100), 64) == 16  # twice as many at most
    assert seeds_wanted([wide], 8, Fraction(1, 100), 9) == 9
    assert seeds_wanted([wide], 8, Fraction(1, 100), 8) == 8
    assert seeds_wanted([[2.0] * 8, wide], 8, Fraction(9, 100), 64) == 12, "the widest decides"


@given(st.lists(values, max_size=4), st.fractions("1/100", "1/2"), st.integers(8, 20))
def test_it_asks_for_more_unless_all_profits_are_known(
    profits: list[list[float]], tolerance: Fraction, most: int
) -> None:
    wanted = seeds_wanted(profits, 8, tolerance, most)
    known = all(half_width(each, CORRECTED) <= tolerance * np.mean(each) for each in profits)
    assert (wanted == 8) == (known or most == 8)
    assert 8 <= wanted <= min(16, most)


def test_what_more_seeds_can_not_tell_needs_none() -> None:
    for profit in ([1.0] * 8, [math.inf] * 8, [math.inf, *[1.0] * 7], [0.0] * 8):
        assert seeds_wanted([profit], 8, TWO_PERCENT, 64) == 8
    assert seeds_wanted([], 8, TWO_PERCENT, 64) == 8


def test_equal_draws_are_no_exact_mean() -> None:
    assert corrected_interval([4.0] * 8, TWO_PERCENT, is_drawn=True) == (3.92, 4.08)
    assert corrected_interval([4.0] * 8, TWO_PERCENT, is_drawn=False) == (4.0, 4.0)
    assert corrected_interval([4.0, math.inf], TWO_PERCENT, is_drawn=True) is None
    assert corrected_interval([4.0], TWO_PERCENT, is_drawn=True) is None


def stopped(draws: list[float]) -> list[float]:
    """The draws that a point of one profit takes."""
    n = 8
    while (wanted := seeds_wanted([draws[:n]], n, TWO_PERCENT, len(draws))) > n:
        n = wanted
    return draws[:n]


@pytest.mark.parametrize("deviation", [0.02, 0.04, 0.06])
@pytest.mark.parametrize("skewness", [0, 1])
def test_intervals_hold_19_times_of_20_although_their_values_chose_the_number(
    deviation: float, skewness: float
) -> None:
    random = np.random.default_rng(5)
    shape = (1500, 300)
    draws = random.standard_normal(shape)
    if skewness:
        heavy = 4 / skewness**2
        draws = (random.gamma(heavy, 1, shape) - heavy) / math.sqrt(heavy)
    held = 0
    for row in (1 + deviation * draws).tolist():
        low, high = corrected_interval(stopped(row), TWO_PERCENT, is_drawn=True) or (2, 2)
        assert (high - low) / (high + low) <= 0.02 + 1e-9
        held += low <= 1 <= high
    assert held / shape[0] >= 0.95 - 2 * math.sqrt(0.05 * 0.95 / shape[0])
