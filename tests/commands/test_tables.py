"""Tables in any width: nothing is cut, no line is too wide, numbers stay on one line."""

from __future__ import annotations

import re
from io import StringIO

import pytest
from rich.console import Console

from simmpp.commands.parts.tables import Fitting, numbers, table, texts

PROFITS = [
    {
        "scene": "mountain:3",
        "processors": str(nb),
        "fraction": fraction,
        "policy": policy,
        "ready_order": order,
        "seeds": 2,
        "time profit": f"{nb * 1.111:.3f} +- 0.{nb}00",
        "message profit": f"{nb * 11.11:.3f} +- 0.{nb}05",
    }
    for nb in (4, 8)
    for fraction in ("0.1", "0.5")
    for policy in ("concurrent", "ray")
    for order in ("breadth-first", "depth-first")
]
SOURCES = [
    ("placement.pixels", "rows", "open in Nebel 1998; scan lines dealt out in turn were usual"),
    ("policy.concurrent.ask_at_least", "64", "ESTIMATE: a sufficient count, and no number for it"),
]
MEASURES = [
    ("makespan", ["12.8902 ms", "9.57043 ms", "3.51355 ms", "1.616 ms"]),
    ("  against replicated", ["0.125", "0.169", "0.460", "1.000"]),
]
POLICIES = ("object", "ray", "concurrent", "replicated")
LONG = [{"file": "a-very/long/name-of/a-scene-that-no-terminal/holds.parquet", "rays": 12345}]


def printed(fitting: Fitting, width: int) -> str:
    console = Console(file=StringIO(), width=width, color_system=None, markup=False)
    console.print(fitting)
    return console.file.getvalue()  # type: ignore[attr-defined, no-any-return]


@pytest.mark.parametrize("width", [40, 60, 80, 100, 120, 160])
@pytest.mark.parametrize(
    ("fitting", "wholes"),
    [
        (table(PROFITS, n_keys=5), [str(row[n]) for row in PROFITS for n in list(row)[6:]]),
        (texts(("reading mixed sets", "value", "source"), SOURCES), ["placement.pixels", "64"]),
        (numbers(POLICIES, MEASURES), [*POLICIES, *(c for _, cells in MEASURES for c in cells)]),
        (table(LONG), ["12345"]),
    ],
)
def test_no_number_is_cut_and_no_line_is_too_wide(
    fitting: Fitting, wholes: list[str], width: int
) -> None:
    text = printed(fitting, width)
    assert max(map(len, text.splitlines())) <= width
    assert "…" not in text
    for whole in wholes:
        assert re.search(rf"(^|\s){re.escape(whole)}(\s|$)", text, re.MULTILINE), whole


def test_what_fits_is_one_table() -> None:
    lines = printed(table(PROFITS, n_keys=5), 120).splitlines()
    assert lines[0].split()[:2] == ["scene", "processors"]
    assert len(lines) == 1 + len(PROFITS)


def test_constant_columns_go_first() -> None:
    lines = printed(table(PROFITS, n_keys=5), 80).splitlines()
    assert lines[0].rstrip() == "scene mountain:3, seeds 2"
    assert lines[1].split()[0] == "processors"
    assert len(lines) == 2 + len(PROFITS)


def test_then_the_first_columns_go_above_the_rows_that_share_them() -> None:
    text = printed(table(PROFITS, n_keys=5), 60)
    sections = [line.rstrip() for line in text.splitlines() if line.startswith("processors")]
    assert sections == [f"processors {nb}, fraction {x}" for nb in (4, 8) for x in (0.1, 0.5)]
    assert [line.split()[-1] for line in text.splitlines() if line.startswith("policy")] == [
        "profit"
    ] * 4


def test_policies_go_below_each_other() -> None:
    heads = [line.split() for line in printed(numbers(POLICIES, MEASURES), 60).splitlines()]
    assert [line for line in heads if line and line[0] in POLICIES] == [
        ["object", "ray", "concurrent"],
        ["replicated"],
    ]


def test_without_room_for_sentences_each_row_has_lines_of_its_own() -> None:
    lines = printed(texts(("set", "value", "source"), SOURCES), 50).splitlines()
    assert [line.rstrip() for line in lines[:4]] == [
        "set",
        "placement.pixels",
        "  value   rows",
        "  source  open in Nebel 1998; scan lines dealt out",
    ]


def test_nothing_is_a_table_too() -> None:
    assert printed(table([]), 60).strip() == ""
    assert printed(texts(("name", "value"), []), 60).strip() == ""
    assert printed(table([{"what": "equal " * 20, "value": 5}] * 2), 60).startswith("what equal")
