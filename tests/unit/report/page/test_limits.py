"""What limits the points of a page: as far as rows, machines and accounts of PEs tell."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from by_hand import MACHINE
from sweep_rows import row, written

from simmpp.common.files import Row
from simmpp.report.page.folder import read_folder
from simmpp.report.page.limits import (
    PointLimits,
    limit_sentences,
    limit_table,
    limits_of_points,
)
from simmpp.report.page.report import report_of, write_page
from simmpp.run.limits import BANDWIDTH, COMPUTE, COPYING, HOT, IMBALANCE, LATENCY, STARTUPS
from simmpp.run.machines import MACHINE_OF
from simmpp.sweeps.winners.points import points_of

FOUR = replace(MACHINE, shape=(4, 1, 1))
NUMBERS: dict[str, Any] = {
    "processors": 4,
    "makespan_ps": 1000,
    "compute_ps": 1600,
    "communication_ps": 800,
    "waiting_ps": 1600,
    "messages": 10,
    "request_messages": 10,
    **dict.fromkeys(("object_messages", "ray_messages", "load_messages", "rays_sent"), 0),
    "bytes_sent": 100,
}


def limits_in(
    folder: Path, rows: list[Row], record: dict[str, Any], further: tuple[str, ...] = ()
) -> PointLimits:
    (written(folder, rows, further) / "run.json").write_text(json.dumps(record))
    found = read_folder(folder)
    return limits_of_points(found, points_of(found.rows, found.further))


def a_run(folder: Path) -> PointLimits:
    """PEs are busy for 900, 500, 500 and 500 of 1000 ps: the mean is 600."""
    accounts = {"compute_ps": [700, 300, 300, 300], "communication_ps": [200] * 4}
    record = {"machines": [asdict(FOUR)], "policies": [{"policy": "object", "pes": accounts}]}
    return limits_in(folder, [row(**NUMBERS)], record)


def test_a_run_tells_all_parts(tmp_path: Path) -> None:
    limits = a_run(tmp_path)
    assert limits.of[0].parts_ps == {
        COMPUTE: 1600,
        STARTUPS: 10 * (10 + 2 + 20 + 6),
        COPYING: 800 - 380,
        HOT: 4 * (900 - 600),
        IMBALANCE: 0,
        LATENCY: 373,  # of 4 x 100: 10 x 140 of latency and 4 / 3 hops, 100 bytes
        BANDWIDTH: 27,
    }
    (line,) = limit_table(limits)
    assert line == {
        "policy": "object dataflow",
        "makespan": "1 ns",
        "compute": "40 %",
        "startups": "9.5 %",
        "copying": "10.5 %",
        "one hot PE": "30 %",
        "imbalance": "0 %",
        "latency": "9.32 %",
        "bandwidth": "0.675 %",
        "limited most by": "one hot PE",
        "would help first": "deal pixels otherwise (placement.pixels)",
    }
    ((text, points),) = limit_sentences(limits)
    assert points == (0,)
    assert text == (
        "Object dataflow is limited most by one hot PE, 30 % of the makespan (compute is 40 %); "
        "what would help first: deal pixels otherwise (placement.pixels)."
    )


def test_a_sweep_tells_what_its_rows_know(tmp_path: Path) -> None:
    rows = [
        row(policy, seed, **NUMBERS | {"makespan_ps": t, "waiting_ps": w, "fraction": x})
        for policy, t, w in (("object", 1000, 1600), ("ray", 700, 400))
        for x in (0.5, 1.0)
        for seed in (0, 1)
    ]
    limits = limits_in(tmp_path, rows, {"machines": [asdict(FOUR)]})
    assert limits.parts == ["compute", "startups", "copying", "waiting"]
    assert [line["policy"] for line in limit_table(limits)] == ["ray dataflow"] * 2
    assert [line["x"] for line in limit_table(limits)] == ["50 %", "100 %"]
    ((text, points),) = limit_sentences(limits)
    assert points == (1, 3)
    assert text == (
        "Besides computing, the fastest dataflow is limited most by copying in 2 of 2 cases (15 % "
        "of the makespan)."
    )


def test_machines_that_differ_are_told_by_what_was_swept(tmp_path: Path) -> None:
    slow, at = replace(FOUR, send_startup_ps=99), {"processors": 4, "machine.send_startup": "99 ps"}
    record = {"machines": [asdict(FOUR), asdict(slow)], MACHINE_OF: [{"at": at, "machine": 1}]}
    rows = [row(**NUMBERS, **{"machine.send_startup": cell}) for cell in ("99 ps", "1 ps")]
    limits = limits_in(tmp_path, rows, record, ("machine.send_startup",))
    assert ["startups" in of.parts_ps for of in limits.of.values()] == [False, True]


def test_machines_that_differ_are_not_mistaken_for_each_other(tmp_path: Path) -> None:
    machines = [asdict(FOUR), asdict(replace(FOUR, send_startup_ps=99))]
    limits = limits_in(tmp_path, [row(**NUMBERS)], {"machines": machines})
    assert limits.parts == ["compute", "communication", "waiting"]


def test_records_of_other_versions_are_no_hindrance(tmp_path: Path) -> None:
    for record in ({}, {"machines": [{"shape": [4, 1, 1]}, 3], "policies": [{}, 4]}):
        limits = limits_in(tmp_path, [row(**NUMBERS)], record)
        assert limits.parts == ["compute", "communication", "waiting"]
    assert limits_in(tmp_path, [row(waiting_ps="")], {}).of == {}


def test_the_page_has_them(tmp_path: Path) -> None:
    limits = a_run(tmp_path)
    page = write_page(report_of(read_folder(tmp_path))).read_text(encoding="utf-8")
    assert "<h2>What limits it</h2>" in page
    assert "<td>deal pixels otherwise (placement.pixels)</td>" in page
    assert limits.told(0).replace("(", "\\u0028") in page or limits.told(0) in page
    assert page.count('<details class="more">') == 1
