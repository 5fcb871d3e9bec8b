"""When a claim holds, holds in part, or does not."""

from __future__ import annotations

import math

import pytest

from simmpp.studies.nebel98.verdict import (
    DOES_NOT,
    HOLDS,
    IN_PART,
    Criterion,
    by_what,
    judged,
    verdict,
)


def criteria(*values: float) -> list[Criterion]:
    return [Criterion(f"case {n}", value, low=1) for n, value in enumerate(values)]


@pytest.mark.parametrize(
    ("parts", "expected"),
    [
        ([criteria(1, 2)], HOLDS),
        ([criteria(1, 2), criteria()], HOLDS),
        ([criteria(1, 0)], IN_PART),
        ([criteria(1, 0, 0)], DOES_NOT),
        ([criteria(1, 1, 1, 1), criteria(0)], DOES_NOT),
        ([criteria(1, 1, 1, 1), criteria(0, 1)], IN_PART),
        ([criteria(math.nan)], DOES_NOT),
    ],
)
def test_in_part_is_half_of_the_cases_of_each_part(
    parts: list[list[Criterion]], expected: str
) -> None:
    assert judged(parts) == expected


def test_bounds_count_unless_strict() -> None:
    assert Criterion("", 1, low=1, high=1).holds
    assert not Criterion("", 1, low=1, strict=True).holds
    assert not Criterion("", math.nan, low=1).holds


def test_by_names_the_tightest_case_with_its_accounts() -> None:
    tight = Criterion("b", 1.5, 1, 1.6, accounts={"object": {"compute": 0.25, "waiting": 0.75}})
    text = by_what([[Criterion("a", 1.3, 1, 1.6), tight], [Criterion("c", 3, high=2)]])
    assert text == (
        "2 of 2; tightest: b: 1.5 (wanted 1 to 1.6); object: compute 25%, waiting 75%; "
        "c: 3 (wanted <= 2)"
    )


def test_missing_values_are_the_worst() -> None:
    assert "worst: b: nan" in by_what([[Criterion("a", 0, low=1), Criterion("b", math.nan, low=1)]])


def test_a_verdict_cites_the_paper() -> None:
    assert verdict("F0", "figure 0: so", "so", criteria(1)).paper == "Nebel 1998, figure 0: so"
