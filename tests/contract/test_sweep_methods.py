"""The analytical model as rows of a sweep: its numbers, and what it does not know."""

import math

import pandas
import pytest

from simmpp.common.errors import ConfigError
from simmpp.config.config import config_from_mapping
from simmpp.methods.table import METHODS
from simmpp.model.analytical import analytical, rays_of
from simmpp.model.costs import costs_of
from simmpp.model.measured import measured
from simmpp.model.synchronous import synchronous
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.run.inputs import workload_of
from simmpp.sweeps.plan import plan_of
from simmpp.sweeps.sweep import run_sweep

CONFIG = {
    "scene": "tetra:2",
    "reading": "plain",
    "picture": {"resolution": 12},
    "processors": 4,
    "seeds": [0, 1],
    "policy": ["object", "ray"],
    "sweep": {"method": list(METHODS), "memory.fraction": [0.1, 0.5, 1]},
}


@pytest.fixture(scope="module")
def rows() -> pandas.DataFrame:
    return run_sweep(CONFIG).rows


def test_every_method_has_its_rows_and_profits(rows: pandas.DataFrame) -> None:
    assert rows["error"].isna().all()
    assert (rows.groupby("method").size() == 3 * 2 * 2).all()
    assert (
        rows[rows["method"] == "analytical"].groupby("fraction")["makespan_ps"].nunique().max() == 2
    )
    profits = run_sweep(CONFIG).profits
    assert list(profits.columns[:6]) == [
        "scene", "processors", "fraction", "effective_fraction", "policy", "method",
    ]  # fmt: skip
    assert len(profits) == 3 * 2 * len(METHODS)
    for _, of_point in profits.groupby(["fraction", "method"]):
        assert of_point[of_point["policy"] == "object"]["time_profit"].item() == 1


def test_analytical_rows_are_the_formulas(rows: pandas.DataFrame) -> None:
    config = config_from_mapping(CONFIG)
    workload, machine = workload_of(config), config.machine_for(4)
    times = analytical(costs_of(machine, workload), [4], [0.1, 0.5, 1], rays_of(workload))
    for policy in ("object", "ray"):
        chosen = rows[(rows["method"] == "analytical") & (rows["policy"] == policy)]
        of_seed = chosen[chosen["seed"] == 1].sort_values("fraction")
        assert of_seed["makespan_ps"].tolist() == [round(t) for t in getattr(times, policy)[0]]
        assert of_seed["effective_fraction"].tolist() == [0.25, 0.5, 1]
    asked = rows[(rows["method"] == "analytical") & (rows["policy"] == "object")]
    # a test lacks its object with probability 1 - x, where x is 1/nb at least; each is two messages
    expected = [2 * round((1 - max(x, 0.25)) * workload.n_tests) for x in asked["fraction"]]
    assert asked["messages"].tolist() == expected
    sent = rows[(rows["method"] == "analytical") & (rows["policy"] == "ray")]
    assert set(sent["messages"]) == {4 * 3 * len(rays_of(workload).tests)}


def test_measured_rows_are_those_of_the_step_by_step_machine(rows: pandas.DataFrame) -> None:
    config = config_from_mapping(CONFIG)
    workload, machine = workload_of(config), config.machine_for(4)
    of_method = rows[rows["method"] == "analytical-measured"]
    for row in of_method.to_dict("records"):
        memory = Memory(fraction=config_from_mapping({
            "scene": "tetra:2", "memory": {"fraction": row["fraction"]},
        }).memory.fraction)  # fmt: skip
        placement = place(workload, 4, memory, PlacementRules(), row["seed"])
        found = measured(workload, machine, placement, row["policy"])
        counts = synchronous(workload, machine, placement, row["policy"]).counts
        assert row["makespan_ps"] == found.makespan_ps
        assert found.lacking == counts.rays.sum()
        messages = 2 * found.lacking if row["policy"] == "object" else 12 * found.steps
        assert row["messages"] == messages


def test_what_the_model_does_not_know_is_empty(rows: pandas.DataFrame) -> None:
    models = rows[rows["method"] != "simulate"]
    simulated = rows[rows["method"] == "simulate"]
    for unknown in (
        "engine",
        "bytes_sent",
        "waiting_ps",
        "communication_ps",
        "peak_bytes",
        "events",
    ):
        assert models[unknown].isna().all()
        assert simulated[unknown].notna().all()
    for known in ("rays", "tests", "compute_ps"):
        assert models[known].nunique() == 1
        assert set(models[known]) == set(simulated[known])


def test_a_model_has_its_tolerance_too() -> None:
    _, profits = run_sweep({
        **CONFIG, "tolerance": "10%", "max_seeds": 12, "sweep": {"method": ["analytical-measured"]},
    })  # fmt: skip
    assert set(profits["n"]) <= set(range(8, 13))
    alone = {**CONFIG, "tolerance": "10%", "method": "analytical", "sweep": {}}
    profits = run_sweep(alone).profits
    assert "method" not in profits.columns
    assert len(plan_of(config_from_mapping(alone)).tasks) == 2
    assert (profits["time_profit_low"] == profits["time_profit_high"]).all()


@pytest.mark.parametrize(
    ("more", "problem"),
    [
        (
            {"policy": "concurrent"},
            "policy: value 'concurrent': method analytical knows object",
        ),
        ({"memory": {"bytes": "1 kB"}}, "memory.bytes: method analytical knows shares"),
        ({"policy": "ray", "method": "measured"}, "method: value 'measured': expected simulate, "),
    ],
)
def test_what_no_model_has_is_refused(more: dict[str, object], problem: str) -> None:
    config = {"scene": "tetra:1", "method": "analytical", "policy": "ray", **more}
    with pytest.raises(ConfigError, match=problem):
        run_sweep(config)


def test_methods_of_different_policies_are_linked() -> None:
    sweep = {"method, policy": [["simulate", ["ray", "concurrent"]], ["analytical", "ray"]]}
    profits = run_sweep({**CONFIG, "sweep": sweep}).profits
    assert sorted(zip(profits["policy"], profits["method"], strict=True)) == [
        ("concurrent", "simulate"), ("object", "analytical"), ("object", "simulate"),
        ("ray", "analytical"), ("ray", "simulate"),
    ]  # fmt: skip
    assert not math.isnan(profits["time_profit"].min())
