"""Equal points are simulated once, and only equal ones."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

from simmpp.config.config import config_from_mapping, with_key
from simmpp.methods.columns import FURTHER, NUMBERS
from simmpp.methods.simulation import integers
from simmpp.report.page.folder import read_folder
from simmpp.run.inputs import workload_of
from simmpp.run.point import make_point, run_point
from simmpp.sweeps.plan import plan_of
from simmpp.sweeps.sweep import run_sweep
from simmpp.sweeps.worker import run_task

SETTINGS = {
    "scene": "tetra:2",
    "picture": {"resolution": 8},
    "processors": 4,
    "sweep": {"memory.fraction": [0.5, 0.1, 1], "policy": ["object", "replicated"]},
}


def test_the_replicated_scene_lends_its_memory_to_no_other_point() -> None:
    # 0.1 is the default fraction, which once stood for "everything" in the keys of placements
    rows = run_sweep(SETTINGS).rows
    of_object = rows[rows["policy"] == "object"].set_index("fraction")["effective_fraction"]
    assert of_object[0.1] < of_object[0.5] < of_object[1.0] == 1
    assert set(rows[rows["policy"] == "replicated"]["makespan_ps"]) == {
        *rows[(rows["policy"] == "object") & (rows["fraction"] == 1)]["makespan_ps"]
    }


def test_where_everything_is_in_memory_all_policies_are_one() -> None:
    for sweep in ({"memory.fraction": [1]}, {"processors": [1], "memory.fraction": [0.1, 0.5]}):
        given = {**SETTINGS, "sweep": {"policy": ["object", "ray", "concurrent"], **sweep}}
        plan = plan_of(config_from_mapping(given))
        assert len(plan.tasks) == 1
        rows = plan.rows({task.key: run_task(task) for task in plan.tasks})
        for each in rows:
            config = config_from_mapping({**given, "sweep": {}, "policy": each["policy"]})
            config = with_key(config, "processors", each["processors"])
            config = with_key(config, "memory.fraction", each["fraction"])
            point = make_point(config, workload_of(config))
            (alone,) = (run for run in run_point(point) if run.parameters.title == each["policy"])
            known = {name: each[name] for name in (*NUMBERS, *FURTHER) if each[name] != ""}
            assert integers(alone.result) == known


def test_what_is_kept_and_dealt_stands_in_rows_as_it_was_written(tmp_path: Path) -> None:
    # 16 objects: a quarter is 4
    sweep = {
        "memory.transient": [0, "0%", 4, "25%", "x", "100%"],
        "placement.pixels": ["blocks", "rows", {"cells": 3}, {"cells": 1}, "interleaved"],
        "policy": ["object", "replicated"],
    }
    given = {**SETTINGS, "memory": {"fraction": 0.25}, "sweep": sweep}
    plan = plan_of(config_from_mapping(given))
    of_object, of_replicated = 4 * 5, 5  # {0, 0%}, 4, {25%, x}, 100%; transient memory of nothing
    assert len(plan.tasks) == of_object + of_replicated
    run_sweep(given, out=tmp_path)
    rows = read_folder(tmp_path).rows
    kept: dict[object, set[object]] = defaultdict(set)
    dealt: dict[object, set[object]] = defaultdict(set)
    for row in rows:
        numbers = tuple(row[name] for name in NUMBERS)
        values = row["memory.transient"], row["placement.pixels"]
        if row["policy"] == "object":
            kept[values[0]].add((values[1], numbers))
            dealt[values[1]].add((values[0], numbers))
        else:
            kept["replicated", values[1]].add(numbers)
    assert kept[0] == kept["0%"] != kept[4] == kept["25%"] == kept["x"] != kept["100%"]
    assert dealt['{"cells": 1}'] == dealt["interleaved"] != dealt['{"cells": 3}'] != dealt["rows"]
    assert {len(kept["replicated", pixels]) for pixels in dealt} == {1}
