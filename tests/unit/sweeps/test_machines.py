"""Machines in seconds: rows on the left, what is said of machines on the right."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import pytest
from sweep_rows import failed, timed

from simmpp.common.files import Row
from simmpp.machine.presets import machine
from simmpp.run.machines import MACHINE_OF, machine_of, machines_told
from simmpp.sweeps.winners.answer import answer
from simmpp.sweeps.winners.machines import Machines, machines_of
from simmpp.sweeps.winners.machines_told import machine_sentences, machine_table
from simmpp.sweeps.winners.points import points_of

PRESET = "machine.preset"
MS = 10**9


def on(name: str, nb: int, *ray_ms: float, key: str = PRESET, **cells: Any) -> list[Row]:
    """Rows of a machine: ray dataflow with these times, object dataflow slower."""
    cells = {key: name, "processors": nb, **cells}
    ray = [round(ms * MS) for ms in ray_ms]
    return [*timed("ray", *ray, **cells), *timed("object", *(3 * ps for ps in ray), **cells)]


def compared(rows: list[Row], *further: str, record: Any = None) -> Machines:
    return machines_of(points_of(rows, further or (PRESET,)), record or {})


def said(found: Machines) -> list[str]:
    return [sentence.text for sentence in machine_sentences(found)]


TWO = [
    *on("t3e", 4, 80, 81),
    *on("t3e", 8, 50, 51),
    *on("cluster", 4, 20, 20.5),
    *on("cluster", 8, 16, 16.5),
]


def test_who_finishes_first_and_who_takes_fewest_node_seconds() -> None:
    assert said(compared(TWO)) == [
        "Of 2 machines cluster finishes first: 16.2 ms (ray dataflow, 8 PEs); the next, t3e, takes "
        "3.11 times as long.",
        "The fewest node-seconds takes cluster: 81 ms (ray dataflow, 4 PEs); the next, t3e, takes "
        "3.98 times as many.",
    ]


def test_the_answer_has_it_in_place_of_the_shortest_time() -> None:
    points = points_of(TWO, (PRESET,))
    texts = [sentence.text for sentence in answer(points, machines_of(points, {}))]
    assert texts[1:] == said(compared(TWO))
    assert "shortest" in " ".join(sentence.text for sentence in answer(points))


def test_the_fastest_dataflow_counts_and_the_replicated_scene_does_not() -> None:
    rows = [*on("a", 4, 10, 10), *on("b", 4, 9, 9)]
    rows += timed("concurrent", *[4 * MS] * 2, processors=4, **{PRESET: "a"})
    rows += timed("replicated", 1, 1, processors=4, effective_fraction=1.0, **{PRESET: "b"})
    first = said(compared(rows))[0]
    assert first.startswith("Of 2 machines a finishes first: 4 ms (concurrent dataflow, 4 PEs)")


def test_few_nodes_may_be_cheapest_on_another_machine() -> None:
    rows = [*on("small", 1, 60, 61), *on("large", 16, 10, 10.1)]
    first, second = said(compared(rows))
    assert first.startswith("Of 2 machines large finishes first")
    assert second.startswith("The fewest node-seconds takes small: 60.5 ms (ray dataflow, 1 PE)")


def test_what_seeds_can_not_tell_is_said() -> None:
    assert said(compared([*on("a", 4, 10, 20), *on("b", 4, 20, 10.1)]))[0].endswith(
        "takes 1 times as long, within what seeds can tell."
    )
    assert said(compared([*on("a", 4, 10), *on("b", 4, 20)]))[0].endswith("as long (one seed).")


def test_works_are_raced_apart() -> None:
    rows = [
        *(row for x in (0.1, 0.2, 0.4) for row in on("a", 4, 10, 10.1, fraction=x)),
        *(row for x in (0.1, 0.2) for row in on("b", 4, 20, 20.1, fraction=x)),
        *on("b", 4, 5, 5.1, fraction=0.4),
    ]
    found = compared(rows)
    assert [race.of for race in found.races] == ["x = 10 %", "x = 20 %", "x = 40 %"]
    assert said(found)[0] == (
        "Of 2 machines a finishes first in 2 of 3 cases, b in 1; the next takes 1.99 to 2 times "
        "as long."
    )


def test_nothing_is_said_where_there_is_one_machine_or_none_has_a_rival() -> None:
    assert said(compared(on("a", 4, 10, 11))) == []
    apart = [*on("a", 4, 10, 11, scene="s"), *on("b", 4, 10, 11, scene="t")]
    assert said(compared(apart)) == [] and machine_table(compared(apart)) == []
    assert said(compared([*on("a", 4, 10), failed("ray", processors=4, **{PRESET: "b"})])) == []


LINKED = ("machine.latency", "machine.file", "machine")
NAMES = [
    ({"machine.latency": "1 us"}, {"machine.latency": "2 us"}, "latency 1 us"),
    ({"machine.file": "a.yaml"}, {"machine.file": "b.yaml"}, "a.yaml"),
    ({"machine": '{"preset": "t3e"}'}, {"machine": '{"file": "b.yaml", "quantum": 8}'}, "t3e"),
    (
        {"machine": '{"preset": "t3e", "levels": {"n": {}}}'},
        {"machine": '{"preset": "t3d"}'},
        't3e, levels {"n": {}}',
    ),
]


@pytest.mark.parametrize(("one", "other", "name"), NAMES)
def test_machines_are_called_by_what_is_swept(one: Row, other: Row, name: str) -> None:
    rows = [row | cells for cells in (one, other) for row in timed("ray", 10, processors=4)]
    found = compared(rows, *one)
    assert found.races[0].machines[0] == name or found.races[0].machines[1] == name


POINT_ROWS = [*on("small", 4, 10, 11, key="point"), *on("large", 64, 5, 5.1, key="point")]


def test_named_points_are_machines_if_they_set_nothing_else() -> None:
    named = [{"name": "small", "machine.preset": "t3d"}, {"name": "large", "processors": 64}]
    record = {"config": {"sweep": {"points": named}}}
    assert compared(POINT_ROWS, "point", record=record).races[0].machines == ["small", "large"]
    other = {"config": {"sweep": {"points": [*named[:1], {"name": "large", "scene": "x"}]}}}
    for unknown in (other, {}, {"config": {"sweep": {"points": 3}}}):
        assert not compared(POINT_ROWS, "point", record=unknown).races


def recorded(*presets: str, nb: int = 4) -> dict[str, Any]:
    """A record of these machines."""
    machines = [asdict(machine(name, processors=nb)) for name in presets]
    cells = ({"processors": nb, PRESET: name, "policy.batch": 3} for name in presets)
    told = machines_told(machines, zip(cells, range(len(presets)), strict=True))
    return {"machines": machines, MACHINE_OF: told}


def test_energy_and_price_are_told_where_machines_state_them() -> None:
    names = ("gpu-node", "gpu-cluster")
    rows = [*on(names[0], 4, 10, 10), *on(names[1], 4, 20, 20)]
    found = compared(rows, record=recorded(*names))
    # 4 PEs x 10 ms x 938 W; 4 x 20 ms x 628 W; only one of both has a price, 4.916 an hour
    assert said(found)[2:] == [
        "The least energy takes gpu-node: 37.5 J (ray dataflow, 4 PEs); the next, gpu-cluster, "
        "takes 1.34 times as much."
    ]
    first, second = machine_table(found)
    assert first == {
        "machine": "gpu-cluster",
        "PEs": "4",
        "fastest dataflow": "ray dataflow",
        "makespan": "20 ms",
        "node-seconds": "80 ms",
        "energy": "50.2 J",
        "price": "",
    }
    assert second["price"] == f"{4 * 0.01 / 3600 * 4.916:.3g}"


def test_a_record_tells_whose_a_machine_is() -> None:
    record = recorded("gpu-node", "gpu-cluster")
    assert record[MACHINE_OF][1] == {
        "at": {"processors": 4, PRESET: "gpu-cluster"},
        "machine": 1,
    }
    row = {"processors": 4, PRESET: "gpu-cluster"}
    assert (machine_of(record, row) or {})["name"] == "gpu-cluster"
    assert machine_of(record, row | {PRESET: "t3e"}) is None
    one = {"machines": record["machines"][:1]}  # where one number of PEs has one machine
    assert (machine_of(one, row) or {})["name"] == "gpu-node"
    assert machine_of({"machines": record["machines"]}, row) is None
    assert machine_of(one, row | {"processors": 5}) is None
    assert machines_told(one["machines"], []) == []
    for damaged in ({}, {"machines": 3}, {"machines": [3], MACHINE_OF: [4, {"at": {}}]}):
        assert machine_of(damaged, row) is None
