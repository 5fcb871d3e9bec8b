"""Equal points are simulated once, and only equal ones."""

from __future__ import annotations

from simmpp.config.config import config_from_mapping, with_key
from simmpp.methods.columns import NUMBERS
from simmpp.methods.simulation import integers
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
            assert integers(alone.result) == {name: each[name] for name in NUMBERS}
