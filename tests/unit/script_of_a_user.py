"""A user's script, which mypy checks strictly with the package: what calls take and give.

What must not pass is marked; mypy complains of a mark that is not needed.
"""

from __future__ import annotations

from fractions import Fraction
from typing import assert_type

import pandas
from matplotlib.figure import Figure

import simmpp


def simulated(processors: int) -> list[simmpp.Result]:
    workload = simmpp.trace(simmpp.load_scene("tetra:2"), simmpp.Picture(resolution=8))
    machine = simmpp.make_machine("t3e", {"send_startup": "5 us"}, processors)
    memory = simmpp.Memory(fraction="10%")
    rules = simmpp.PlacementRules(pixels=simmpp.Cells(2))
    placement = simmpp.place(workload, processors, memory, rules, seed=0)
    policies = ("object", "ray", simmpp.PolicyParameters("concurrent", min_load="5%"))
    return [simmpp.simulate(workload, machine, placement, policy) for policy in policies]


def taken() -> list[Fraction]:
    for memory in (simmpp.Memory(0.1), simmpp.Memory("1/10"), simmpp.Memory(bytes="2 GB")):
        assert_type(memory.share, Fraction)
        assert_type(memory.bytes, int | None)
    refreshed = simmpp.PolicyParameters(load_info={"refresh": "12 us"})
    assert refreshed == simmpp.PolicyParameters(refresh_ps=12_000_000)
    assert_type(refreshed.min_load, Fraction | int)
    return [simmpp.Memory(share).share for share in (0.1, "10%", Fraction(1, 10))]


def given(results: list[simmpp.Result]) -> tuple[pandas.DataFrame, simmpp.SweepResult]:
    assert_type(results[0].makespan_ps, int)
    assert_type(results[0].plot(), Figure)
    assert_type(simmpp.profits(results)[0].time, float)
    table = simmpp.sweep({"scene": "tetra:2", "picture": {"resolution": 8}, "processors": 4})
    rows, profits = table
    assert_type(rows, pandas.DataFrame)
    assert_type(table.plot(), Figure)
    return profits, table


def refused() -> None:
    simmpp.Memory(fraction=[1])  # type: ignore[arg-type]
    simmpp.Memory(residents="newest")  # type: ignore[arg-type]
    simmpp.PolicyParameters(batch="256")  # type: ignore[arg-type]
    simmpp.simulate("rays", 1, 2, 3)  # type: ignore[arg-type]
    simmpp.trase  # type: ignore[attr-defined]  # noqa: B018
