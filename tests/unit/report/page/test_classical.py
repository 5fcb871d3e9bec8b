"""The best classical way beside other dataflows: by hand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from sweep_rows import failed, row, timed, written

from simmpp.common.files import Row
from simmpp.report.page.classical import duels_of
from simmpp.report.page.findings import further
from simmpp.report.page.folder import read_folder
from simmpp.report.page.report import report_of
from simmpp.sweeps.winners.points import Points, points_of


def duels(rows: list[Row], *further: str) -> list[tuple[Any, ...]]:
    """Policy and further keys of both sides, and the ratio."""
    points = points_of(rows, further)

    def side(number: int) -> tuple[Any, ...]:
        return tuple(points.profits[number][name] for name in ("policy", *further))

    return [(side(d.classical), side(d.other), d.ratio) for d in duels_of(points)]


def told(points: Points) -> list[str]:
    beginning = "With no more memory than "
    return [text for text, _ in further(points) if text.startswith(beginning)]


def test_the_faster_classical_dataflow_of_each_place() -> None:
    rows: list[Row] = []
    for x, by_object, by_ray in ((0.1, 400, 100), (0.2, 200, 500)):
        rows += timed("object", by_object, by_object, fraction=x)
        rows += timed("ray", by_ray, by_ray, fraction=x)
        rows += timed("concurrent", 200, 200, fraction=x)
        rows += timed("replicated", 10, 10, fraction=x)
    assert duels(rows) == [(("ray",), ("concurrent",), 2.0), (("object",), ("concurrent",), 1.0)]
    assert told(points_of(rows, ())) == [
        "With no more memory than concurrent dataflow the best classical way is ray dataflow in 1 "
        "of 2 cases, object dataflow in 1: concurrent dataflow takes 1 to 2 times as long, less "
        "time in none."
    ]


def test_the_ratio_is_the_mean_of_the_seeds_own() -> None:
    rows = timed("object", 100, 200) + timed("concurrent", 50, 1600)
    assert duels(rows) == [(("object",), ("concurrent",), pytest.approx(2))]  # of 1/2 and 8
    (text,) = told(points_of(rows, ()))
    assert text == (
        "With no more memory than concurrent dataflow the best classical way is object dataflow: "
        "concurrent dataflow takes 2 times as long; ray dataflow was not run."
    )


def test_each_side_has_its_best_way_to_deal() -> None:
    pixels, residents = "placement.pixels", "memory.residents"
    times = {
        ("blocks", "random"): (400, 300, 200),
        ("rows", "random"): (90, 300, 180),
        ("blocks", "hot"): (400, 80, 120),
        ("rows", "hot"): (90, 100, 160),
    }
    rows = [
        each
        for (deal, held), of in times.items()
        for policy, t in zip(("object", "ray", "concurrent"), of, strict=True)
        for each in timed(policy, t, **{pixels: deal, residents: held})
    ]
    assert duels(rows, pixels, residents) == [
        (("ray", "blocks", "hot"), ("concurrent", "blocks", "hot"), 1.5)
    ]
    (text,) = told(points_of(rows, (pixels, residents)))
    assert text == (
        "With no more memory than concurrent dataflow the best classical way is ray dataflow "
        "(placement.pixels blocks, memory.residents hot): concurrent dataflow takes 1.5 times as "
        "long."
    )


@pytest.mark.parametrize(
    ("classical", "other", "allowed"),
    [
        (0, 0, True),
        (0, 3, True),
        (0, "x", True),
        ("0%", 3, True),
        (3, 4, True),
        (4, 3, False),
        (3, 0, False),
        ("5%", "x", True),
        ("20%", "x", True),
        ("1/4", "x", False),
        ("x", "1/5", True),
        ("x", "19%", False),
        ("x", "x", True),
        (3, "50%", False),
        ("5%", 50, False),
        ("as ever", "as ever", True),
        ("as ever", "x", False),
    ],
)
def test_a_classical_way_keeps_no_more(classical: object, other: object, allowed: bool) -> None:
    kept = "memory.transient"
    rows = timed("object", 100, fraction=0.2, **{kept: classical})
    rows += timed("concurrent", 150, fraction=0.2, **{kept: other})
    assert duels(rows, kept) == [(("object", classical), ("concurrent", other), 1.5)] * allowed


def test_residents_in_bytes_are_kept_as_many_as_there_are() -> None:
    kept, room = "memory.transient", "memory.bytes"
    rows = [
        each
        for n in ("x", 0)
        for each in (
            *timed("object", 200 if n else 400, fraction="", **{kept: n, room: "1 kB"}),
            *timed("concurrent", 300, fraction="", **{kept: n, room: "1 kB"}),
        )
    ]
    assert duels(rows, kept, room) == [
        (("object", 0, "1 kB"), ("concurrent", 0, "1 kB"), 0.75),
        (("object", "x", "1 kB"), ("concurrent", "x", "1 kB"), 1.5),
    ]
    (text,) = told(points_of(rows, (kept, room)))
    assert text.endswith(
        "object dataflow in 2 of 2 cases (over memory.transient): concurrent dataflow takes 0.75 "
        "to 1.5 times as long, less time in 1; ray dataflow was not run."
    )


def test_as_many_as_are_resident_in_bytes_are_no_share() -> None:
    kept = "memory.transient"
    for classical, other in (("x", "5%"), ("5%", "x"), ("x", 3)):
        rows = timed("object", 200, fraction="", **{kept: classical})
        assert duels(rows + timed("concurrent", 300, fraction="", **{kept: other}), kept) == []


def test_other_memory_other_scenes_and_other_methods_are_not_compared() -> None:
    for key, values in (("fraction", (0.1, 0.2)), ("scene", ("a", "b")), ("point", ("a", "b"))):
        further = (key,) if key == "point" else ()
        rows = timed("object", 100, **{key: values[0]}) + timed("ray", 100, **{key: values[0]})
        assert duels(rows + timed("concurrent", 100, **{key: values[1]}), *further) == []


def test_nothing_is_told_without_a_result_or_another_dataflow() -> None:
    classical = timed("object", 100) + timed("ray", 100) + timed("replicated", 10)
    assert told(points_of(classical, ())) == []
    assert told(points_of([*classical, failed("concurrent")], ())) == []
    apart = [*timed("object", 100), failed("object", 1), failed("concurrent"), row("concurrent", 1)]
    assert told(points_of(apart, ())) == []


POLICIES: list[dict[str, Any]] = [
    {"policy": [{"name": "object", "label": "keen"}, {"name": "concurrent", "label": "eager"}]},
    {"sweep": {"policy": [{"name": "object", "label": "keen"}, ["ray", {"label": "eager"}]]}},
    {"sweep": {"points": [{"name": "a", "policy": {"name": "object", "label": "keen"}}]}},
]


@pytest.mark.parametrize("config", POLICIES)
def test_a_labelled_policy_is_what_the_record_says(tmp_path: Path, config: dict[str, Any]) -> None:
    rows = timed("object", 300) + timed("ray", 200) + timed("keen", 100) + timed("eager", 150)
    written(tmp_path, rows)
    (tmp_path / "run.json").write_text(json.dumps({"config": config}))
    assert told(report_of(read_folder(tmp_path)).points) == [
        "With no more memory than eager the best classical way is keen: eager takes 1.5 times as "
        "long."
    ]
