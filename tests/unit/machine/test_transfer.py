"""Transfer times against exact fractions."""

from __future__ import annotations

from fractions import Fraction
from math import floor

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simmpp.machine.transfer import MAX_BYTES_PER_S, PS_PER_S, transfer_ps


@given(st.integers(0, 10**9), st.integers(1, MAX_BYTES_PER_S))
def test_halves_are_rounded_up(n_bytes: int, bytes_per_s: int) -> None:
    exact = Fraction(n_bytes * PS_PER_S, bytes_per_s)
    if exact < 2**62:
        assert transfer_ps(n_bytes, bytes_per_s) == floor(exact + Fraction(1, 2))


@pytest.mark.parametrize(
    ("n_bytes", "bytes_per_s", "expected"),
    [
        (128, 256_000_000, 500_000),  # half a microsecond
        (1, 2 * PS_PER_S, 1),  # half a picosecond, up
        (1, 2 * PS_PER_S + 1, 0),
        (3, 2 * PS_PER_S, 2),
        (10**12, MAX_BYTES_PER_S, 111_111_111),
        (1 << 40, 0, 0),  # unlimited
    ],
)
def test_worked_by_hand(n_bytes: int, bytes_per_s: int, expected: int) -> None:
    assert transfer_ps(n_bytes, bytes_per_s) == expected
