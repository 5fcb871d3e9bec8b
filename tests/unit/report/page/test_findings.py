"""What a page says in a table and in sentences besides who wins: by hand."""

from __future__ import annotations

import math

import pytest
from sweep_rows import timed

from simmpp.common.files import Row
from simmpp.report.page.findings import wins
from simmpp.run import words
from simmpp.sweeps.winners.points import points_of


def at(fraction: float, *of: tuple[str, tuple[int, ...]]) -> list[Row]:
    return [r for policy, t in of for r in timed(policy, *t, fraction=fraction)]


def test_neighbours_with_one_winner_are_one_line() -> None:
    rows = at(0.1, ("object", (300, 301)), ("ray", (100, 100)))
    rows += at(0.2, ("object", (200, 201)), ("ray", (100, 100)))
    rows += at(0.4, ("object", (100, 100)), ("ray", (110, 130)))
    rows += at(0.8, ("object", (303, 302)), ("ray", (100, 100)))
    rows += at(1.0, ("object", (100, 100)), ("ray", (100, 100)))
    found = wins(points_of(rows, ()))
    assert [(w.winner, w.where, w.places) for w in found] == [
        ("ray", "10 % to 20 %, 80 %", 3),
        ("object", "40 %", 1),
        ("object = ray", "100 %", 1),
    ]
    assert found[0].makespan == "100 ps"
    assert found[0].lead == "2 to 3.02 times as long (object)"
    assert [w.sure for w in found] == [
        "beyond the 95 % interval at each",
        "no difference that these seeds can show",
        "equal in every seed",
    ]


@pytest.mark.parametrize(
    ("values", "text"),
    [((1.0, 1.7123), "1 to 1.71"), ((2.0001, 2.0), "2"), ((), ""), ((1, math.inf), "1 to inf")],
)
def test_spans(values: tuple[float, ...], text: str) -> None:
    assert words.span(values) == text


@pytest.mark.parametrize(
    ("name", "cell", "text"),
    [
        ("fraction", 0.05, "5 %"),
        ("processors", 64, "64"),
        ("scene", "mountain:5", "mountain:5"),
        ("machine.quantum", 16, "16 tests"),
        ("machine.latency", "5 us", "5 us"),
        ("memory.transient", 3, "3"),  # objects, or a share
        ("point", 2, "2"),
        ("fraction", "", "none"),
    ],
)
def test_values_have_units(name: str, cell: object, text: str) -> None:
    assert words.value(name, cell) == text
