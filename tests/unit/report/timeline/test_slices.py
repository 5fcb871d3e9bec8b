"""Rows of an event log become slices that touch."""

import numpy as np

from simmpp.engine.arrays.records import COMPUTE, EVENT
from simmpp.report.timeline.slices import IDLE, PROBE, Timeline, Window


def test_a_gap_of_a_picosecond_is_idle() -> None:
    rows = np.zeros(3, EVENT)
    rows["event"], rows["kind"], rows["number"], rows["other"] = COMPUTE, -1, -1, -1
    rows["pe"] = [1, 0, 1]
    rows["time_ps"], rows["end_ps"] = [0, 1, 11], [10, 20, 30]
    timeline = Timeline(2, 2, Window())
    parts = [timeline.add(rows[:1]), timeline.add(rows[1:]), timeline.end(31)]
    slices = [
        row.tolist() for part in parts for row in part.slices[["pe", "time_ps", "event", "end_ps"]]
    ]
    assert sorted(slices) == [
        (0, 0, IDLE, 1), (0, 1, PROBE, 3), (0, 3, COMPUTE, 20), (0, 20, IDLE, 31),
        (1, 0, PROBE, 2), (1, 2, COMPUTE, 10), (1, 10, IDLE, 11), (1, 11, PROBE, 13),
        (1, 13, COMPUTE, 30), (1, 30, IDLE, 31),
    ]  # fmt: skip
