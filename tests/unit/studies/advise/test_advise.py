"""Whole answers on tiny scenes: golden tables, what fits, what does not, orders and broken runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from simmpp.common.errors import ConfigError
from simmpp.common.files import write_csv
from simmpp.config.config import config_from_mapping
from simmpp.run.inputs import workload_of
from simmpp.studies.advise.advice import Advice
from simmpp.studies.advise.advise import advise
from simmpp.studies.advise.candidates import candidates_of
from simmpp.studies.advise.running import Watcher
from simmpp.studies.advise.table import COLUMNS
from simmpp.workload import room

GOLDEN = Path(__file__).parents[3] / "golden" / "advise"
SOME = ["replicated", "object", "ray", "concurrent-random"]
"""Candidates enough for a test."""

Asked = dict[str, Any]


def question(capacity: str, **asked: Any) -> Asked:
    asked = {"processors": [2, 4], "candidates": SOME} | asked
    picture = {"resolution": 16}
    memory = {"capacity": capacity}
    return {"scene": "tetra:3", "picture": picture, "memory": memory, "advise": asked}


PAIRS: dict[str, Asked] = {
    "time": question("7 kB"),
    "node-seconds": question("12 kB", goal="node-seconds") | {"machine": {"preset": "xe6-hopper"}},
    "within": question("9 kB", goal={"least nodes within": "300 us"}, processors=[2, 4, 8]),
}


@pytest.fixture(scope="module")
def answers() -> dict[str, Advice]:
    return {name: advise(asked) for name, asked in PAIRS.items()}


@pytest.mark.parametrize("name", PAIRS)
def test_an_answer_is_what_it_was(name: str, answers: dict[str, Advice], tmp_path: Path) -> None:
    write_csv(answers[name].rows, COLUMNS, tmp_path / "advise.csv")
    told = "".join(f"{line}\n" for line in answers[name].sentences) + answers[name].settings
    for found, path in (
        ((tmp_path / "advise.csv").read_text(), GOLDEN / f"{name}.csv"),
        (told, GOLDEN / f"{name}.txt"),
    ):
        assert found == path.read_text(encoding="utf-8")


def test_what_is_advised_can_be_run_and_takes_as_long(answers: dict[str, Advice]) -> None:
    from simmpp.sweeps.sweep import run_sweep

    advice = answers["time"]
    assert advice.chosen is not None and advice.verdict.chosen is not None
    policy = advice.chosen.policy.title
    base = {key: value for key, value in PAIRS["time"].items() if key != "advise"}
    config = config_from_mapping(base, [f"{k}={v}" for k, v in _flat(advice).items()])
    rows, _ = run_sweep(config)
    found = rows[rows["policy"] == policy]["makespan_ps"].iloc[0]
    assert found == advice.contest.race.costs[advice.verdict.chosen][0]


def _flat(advice: Advice) -> dict[str, str]:
    from simmpp.common.yamlfile import written

    assert advice.chosen is not None
    return {key: written(value) for key, value in advice.chosen.keys.items()}


def test_more_memory_never_makes_what_fits_not_fit() -> None:
    fitted: set[str] = set()
    for size in (2, 3, 5, 9, 17):
        config = config_from_mapping(question(f"{size} kB", processors=[2, 6]))
        found = candidates_of(config, workload_of(config))
        fits = {each.name for each in found if each.fits}
        assert fitted & {each.name for each in found} <= fits, size
        fitted = fits
    assert fitted


def test_the_order_of_candidates_and_nodes_has_no_part_in_it(answers: dict[str, Advice]) -> None:
    turned = question("7 kB", processors=[4, 2], candidates=SOME[::-1])
    again = advise(turned)
    assert again.sentences == answers["time"].sentences
    assert again.rows == answers["time"].rows


def test_nothing_fits_and_more_nodes_would_do() -> None:
    advice = advise(question("3 kB", processors=[1]))
    assert advice.chosen is None and advice.runs == 0
    first, second = advice.sentences
    assert "Nothing fits into 3 kB a node. The least memory that would do is" in first
    assert advice.least_nodes is not None and advice.least_nodes.fits
    assert f"on {advice.least_nodes.processors} PEs: the least nodes that would do" in second


def test_nothing_fits_whatever_the_number_of_nodes() -> None:
    advice = advise(question("10 B", processors=[1024]))
    assert advice.least_nodes is None
    assert "no number of nodes that was looked at would do" in advice.sentences[1]


def test_ctrl_c_tells_the_best_so_far() -> None:
    class Impatient(Watcher):
        def simulated(self, runs: int) -> None:
            if runs == 3:
                raise KeyboardInterrupt

    advice = advise(question("7 kB"), watcher=Impatient())
    assert advice.interrupt is not None and advice.runs == 3
    assert advice.verdict.sure is None
    told = advice.sentences
    assert any(line.startswith("Broken off (interrupted)") for line in told)


def test_when_the_time_is_over_the_best_so_far_is_told() -> None:
    advice = advise(question("7 kB"), seconds=1e-9)
    assert (advice.broken_off, advice.runs) == ("the time was over", 1)


def test_of_what_is_too_large_a_part_is_advised_on(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = question("1 kB") | {"picture": {"resolution": 64}}
    monkeypatch.setattr(room, "_bytes_there_are", lambda: 2000 * room.BYTES_PER_RAY)
    advice = advise(asked)
    assert "the advice is of 32 x 32 pixels of the same view" in advice.left_out
    assert advice.left_out in advice.sentences
    monkeypatch.setattr(room, "_bytes_there_are", lambda: 20 * room.BYTES_PER_RAY)
    with pytest.raises(ConfigError, match="primary rays take"):
        advise(question("1 kB") | {"picture": {"resolution": 16, "max_depth": 1}})


def test_ones_own_candidates_are_raced_too() -> None:
    own = {"name": "mine", "policy": "object", "memory.fraction": "60%"}
    advice = advise(question("7 kB", candidates=["ray", own], processors=[4]))
    assert {each.setup.name for each in advice.candidates} == {"ray", "mine"}


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"advise": {"goal": "fast"}}, "advise.goal: value 'fast': expected time, node-seconds"),
        ({"advise": {"goal": {"least nodes within": "0 s"}}}, "advise.goal: value"),
        ({"advise": {"processors": [4, 4]}}, "advise.processors: value [4, 4]: expected a list"),
        ({"advise": {"processors": [4], "budget": 8}}, "expected processors or budget, got both"),
        ({"advise": {"candidates": ["rey"]}}, "did you mean 'ray'?"),
        ({"advise": {"candidates": ["ray", "ray"]}}, "two are called 'ray'"),
        ({"advise": {"candidates": [{"name": "mine"}]}}, "expected keys such as policy"),
        ({"advise": {"indifference": "100%"}}, "advise.indifference: value '100%': expected"),
        ({"memory": {}}, "memory.capacity: value 'none': expected the memory of a node"),
    ],
)
def test_a_question_that_makes_no_sense_is_one_line(changed: Asked, said: str) -> None:
    with pytest.raises(ConfigError) as caught:
        advise(question("7 kB") | changed)
    assert said in str(caught.value) and "\n" not in str(caught.value)
