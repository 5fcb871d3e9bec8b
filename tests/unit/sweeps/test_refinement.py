"""Where an axis is too coarse: bends are, straight lines and noise are not."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from simmpp.common.errors import ConfigError
from simmpp.config.config import config_from_mapping
from simmpp.sweeps.grid import comparisons
from simmpp.sweeps.refinement import between, identity, moved, refined_keys, too_coarse, value_of

abscissas = st.lists(st.integers(0, 1000), min_size=3, max_size=8, unique=True).map(sorted)
TOLERANCE = Fraction(1, 50)


def exact(heights: list[float]) -> list[list[float]]:
    return [[height] * 8 for height in heights]


@given(abscissas, st.floats(-1, 1), st.floats(2000, 4000))
def test_a_straight_line_needs_no_point(xs: list[int], slope: float, offset: float) -> None:
    line = exact([offset + slope * x for x in xs])
    assert too_coarse([Fraction(x) for x in xs], [line], Fraction(1, 10**9)) == []


@given(abscissas, st.floats(0.01, 100))
def test_a_parabola_needs_points_exactly_where_its_chord_is_off(xs: list[int], bend: float) -> None:
    """The chord of b x^2 over a step h is b h^2 / 4 off in the middle."""
    heights = [1e6 + bend * x * x for x in xs]
    off = [
        bend * (b - a) ** 2 / 4 / min(heights[i : i + 2]) for i, (a, b) in enumerate(pairwise(xs))
    ]
    tolerance = Fraction(float(np.median(off))) * Fraction(1001, 1000)
    assume(all(abs(each / float(tolerance) - 1) > 1e-4 for each in off))
    found = too_coarse([Fraction(x) for x in xs], [exact(heights)], tolerance)
    assert found == [i for i, each in enumerate(off) if each > tolerance]


def test_noise_is_not_refined() -> None:
    random = np.random.default_rng(3)
    xs = [Fraction(n, 10) for n in range(1, 11)]
    curves = (1 + 0.1 * random.standard_normal((200, 10, 8))).tolist()
    refined = [bool(too_coarse(xs, [curve], TOLERANCE)) for curve in curves]
    assert sum(refined) / 200 < 0.05


def test_noise_that_all_points_share_hides_no_bend() -> None:
    """Seeds are paired: what one draw shifts everywhere is no uncertainty of the bend."""
    xs = [Fraction(n) for n in range(5)]
    shifts = 0.2 * np.random.default_rng(4).standard_normal(8)
    heights = [1.0, 1.0, 2.0, 1.0, 1.0]
    curve = [[height + shift for shift in shifts.tolist()] for height in heights]
    assert too_coarse(xs, [curve], TOLERANCE) == [1, 2]


def test_nothing_lies_between_equal_points_and_beside_infinity() -> None:
    xs = [Fraction(n) for n in range(4)]
    assert too_coarse(xs, [exact([1, 1, 2, 2])], TOLERANCE) == [1]
    assert too_coarse(xs, [exact([1, 9, float("inf"), 1])], TOLERANCE) == []
    assert too_coarse(xs[:2], [exact([1, 9])], TOLERANCE) == []


@given(st.fractions(0, 1), st.fractions(0, 1), st.booleans())
def test_the_number_between_is_short_and_in_the_middle(
    low: Fraction, high: Fraction, whole: bool
) -> None:
    assume(low < high)
    scale = 1000 if whole else 1
    low, high = (Fraction(round(each * scale)) if whole else each for each in (low, high))
    number = between(low, high, whole=whole)
    if number is None:
        assert high - low < 2 if whole else high - low < Fraction(1, 10**38)
    else:
        assert low < number < high
        assert not whole or number.denominator == 1
    assert between(Fraction(1, 64), Fraction(3, 100), whole=False) == Fraction(23, 1000)
    assert between(Fraction(2, 5), Fraction(1, 2), whole=False) == Fraction(9, 20)


def config(sweep: dict[str, object]):  # type: ignore[no-untyped-def]
    base = {"scene": "tetra:1", "tolerance": "2%", "refine": True}
    return config_from_mapping({**base, "sweep": sweep})


def test_axes_of_numbers_are_refined() -> None:
    sweep = {
        "memory.fraction": ["1/64", "10%", 0.5],
        "processors": [1, 2, 4],
        "memory.transient": [0, 1, 2],
        "machine.latency": ["1 us", "2 us", "3 us"],
        "picture.resolution": [8, 16, 32],
        "policy.batch": [1, 2, 3],
    }
    assert refined_keys(config(sweep)) == ["memory.fraction", "processors", "memory.transient"]
    for one in ({"processors": [1, 2]}, {"processors, memory.transient": [[1, 1], [2, 2], [3, 3]]}):
        with pytest.raises(ConfigError, match="refine: expected an axis of at least 3 numbers"):
            refined_keys(config(one))


def test_a_comparison_is_moved_along_an_axis() -> None:
    sweep = {"memory.fraction": [0.1, 0.2, 0.3], "memory.transient": [0, 4, 8]}
    first = comparisons(config(sweep))[0]
    wider = moved(first, "memory.fraction", Fraction(1, 4))
    assert value_of(wider, "memory.fraction") == wider.config.memory.fraction == Fraction(1, 4)
    assert identity(wider) != identity(first)
    assert identity(wider, "memory.fraction") == identity(first, "memory.fraction")
    kept = moved(first, "memory.transient", Fraction(2))
    assert (kept.swept["memory.transient"], kept.config.memory.transient) == (2, 2)
    assert identity(kept, "memory.transient") == identity(first, "memory.transient")
    assert identity(kept, "memory.fraction") != identity(first, "memory.fraction")
