"""When a claim holds, holds in part, or does not."""

from __future__ import annotations

import math

import pytest

from simmpp.studies.nebel98.verdict import DOES_NOT, HOLDS, IN_PART, Case, by_what, judged, verdict


def cases(*values: float) -> list[Case]:
    return [Case(f"case {n}", value, low=1) for n, value in enumerate(values)]


@pytest.mark.parametrize(
    ("parts", "expected"),
    [
        ([cases(1, 2)], HOLDS),
        ([cases(1, 2), cases()], HOLDS),
        ([cases(1, 0)], IN_PART),
        ([cases(1, 0, 0)], DOES_NOT),
        ([cases(1, 1, 1, 1), cases(0)], DOES_NOT),
        ([cases(1, 1, 1, 1), cases(0, 1)], IN_PART),
        ([cases(math.nan)], DOES_NOT),
    ],
)
def test_in_part_is_half_of_the_cases_of_each_part(parts: list[list[Case]], expected: str) -> None:
    assert judged(parts) == expected


def test_bounds_count_unless_strict() -> None:
    assert Case("", 1, low=1, high=1).holds
    assert not Case("", 1, low=1, strict=True).holds
    assert not Case("", math.nan, low=1).holds


def test_by_names_the_tightest_case_with_its_accounts() -> None:
    tight = Case("b", 1.5, 1, 1.6, accounts={"object": {"compute": 0.25, "waiting": 0.75}})
    text = by_what([[Case("a", 1.3, 1, 1.6), tight], [Case("c", 3, high=2)]])
    assert text == (
        "2 of 2; tightest: b: 1.5 (wanted 1 to 1.6); object: compute 25%, waiting 75%; "
        "c: 3 (wanted <= 2)"
    )


def test_missing_values_are_the_worst() -> None:
    assert "worst: b: nan" in by_what([[Case("a", 0, low=1), Case("b", math.nan, low=1)]])


def test_a_verdict_cites_the_paper() -> None:
    assert verdict("F0", "figure 0: so", "so", cases(1)).paper == "Nebel 1998, figure 0: so"
