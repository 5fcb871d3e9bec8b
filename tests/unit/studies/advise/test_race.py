"""The race on made-up costs: what is run, what leaves, what is advised and how sure that is."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import pytest

from simmpp.studies.advise.confidence import LEAST_SEEDS, weighted_means
from simmpp.studies.advise.racing import CONFIDENCE, Ask, Contender, Race
from simmpp.studies.advise.verdict import Contest


class Table:
    """Costs by contender and seed; counts what is asked."""

    def __init__(self, costs: Sequence[Sequence[float]]) -> None:
        self.costs, self.asked = costs, list[Ask]()

    def __call__(self, asks: Sequence[Ask]) -> Iterator[tuple[Ask, float]]:
        for n, seed in asks:
            self.asked.append((n, seed))
            yield (n, seed), self.costs[n][seed]


def contest_on(
    costs: Sequence[Sequence[float]],
    bounds: Sequence[float] | None = None,
    sizes: Sequence[int] | None = None,
    limit: float = math.inf,
) -> tuple[Contest, Table]:
    table = Table(costs)
    known = bounds or [0.0] * len(costs)
    contenders = [
        Contender(bound, len(set(row)) > 1) for bound, row in zip(known, costs, strict=True)
    ]
    orders = [(size, n, str(n)) for n, size in enumerate(sizes or [1] * len(costs))]
    return Contest(Race(contenders, table, 0.05), orders, limit), table


def noisy(rng: np.random.Generator, mean: float, spread: float = 0.04) -> list[float]:
    return (mean * np.exp(spread * rng.standard_normal(LEAST_SEEDS))).tolist()


def test_who_is_best_with_every_seed_is_surely_the_best() -> None:
    """No more is claimed than the race itself can be trusted, where seeds differ."""
    rng = np.random.default_rng(0)
    rivals = [noisy(rng, 1.3, 0.02) for _ in range(5)]
    best = [min(row[s] for row in rivals) / 1.06 for s in range(LEAST_SEEDS)]
    contest, _ = contest_on([*rivals, best])
    contest.run()
    verdict = contest.verdict()
    assert (verdict.chosen, verdict.likely[5], verdict.sure) == (5, 1.0, CONFIDENCE)


def test_two_that_differ_by_chance_alone_are_not_sure() -> None:
    rng = np.random.default_rng(1)
    contest, _ = contest_on([noisy(rng, 1.0, 0.2), noisy(rng, 1.0, 0.2)])
    contest.run()
    sure = contest.verdict().sure
    assert sure is not None and 0.3 < sure < 0.98


def test_whose_bound_is_above_what_another_takes_is_never_run() -> None:
    contest, table = contest_on([[10.0]] * 8 + [[30.0]] * 8, [9.0] * 8 + [10.1] * 8)
    contest.run()
    assert {n for n, _ in table.asked} == set(range(8))
    assert sorted(contest.race.dropped) == list(range(8, 16))


@pytest.mark.parametrize("seed", range(20))
def test_a_race_takes_a_fifth_of_all_runs_and_its_choice_is_good(seed: int) -> None:
    rng = np.random.default_rng(seed)
    means = rng.uniform(1.0, 2.0, 60)
    contest, table = contest_on([noisy(rng, mean) for mean in means])
    contest.run()
    chosen = contest.verdict().chosen
    assert chosen is not None and len(table.asked) <= 0.2 * 60 * LEAST_SEEDS
    assert len(set(table.asked)) == len(table.asked)
    assert means[chosen] / means.min() < 1.1


def test_the_order_of_candidates_has_no_part_in_it() -> None:
    rng = np.random.default_rng(3)
    costs = [noisy(rng, mean) for mean in rng.uniform(1.0, 1.2, 12)]
    answers = set()
    for _ in range(5):
        order = rng.permutation(12)
        contest, _ = contest_on([costs[n] for n in order])
        contest.orders = [(1, int(n), str(n)) for n in order]
        contest.run()
        verdict = contest.verdict()
        assert verdict.chosen is not None
        answers.add((int(order[verdict.chosen]), verdict.sure))
    assert len(answers) == 1


def test_of_equals_the_fewest_nodes_are_advised_and_a_tie_is_told() -> None:
    costs = [[1.004], [1.0], [1.04], [1.2]]
    contest, _ = contest_on(costs, sizes=[8, 16, 4, 2])
    contest.run()
    verdict = contest.verdict()
    assert (verdict.chosen, verdict.ties) == (0, [1, 2])


def test_the_least_nodes_within_a_limit() -> None:
    costs, sizes = [[9.0], [6.0], [4.9], [4.0], [2.0]], [2, 4, 8, 8, 16]
    contest, table = contest_on(costs, [8.0, 3.0, 1.0, 1.0, 1.0], sizes, limit=5.0)
    contest.run()
    verdict = contest.verdict()
    assert (verdict.chosen, verdict.is_within, verdict.sure) == (3, True, 1.0)
    assert {n for n, _ in table.asked} == {1, 2, 3}  # 2 nodes can't, 16 need not


def test_a_limit_that_nobody_keeps_is_told() -> None:
    contest, _ = contest_on([[9.0], [6.0]], sizes=[2, 4], limit=5.0)
    contest.run()
    verdict = contest.verdict()
    assert (verdict.chosen, verdict.is_within, verdict.sure) == (1, False, 0.0)


def test_a_race_that_is_broken_off_says_what_was_best_and_not_how_sure() -> None:
    contest, table = contest_on([[5.0], [3.0], *[[4.0]] * 5, [1.0]])

    def measure(asks: Sequence[Ask]) -> Iterator[tuple[Ask, float]]:
        for found in table(asks):
            yield found
            if len(table.asked) == 4:
                raise KeyboardInterrupt

    contest.race.measure = measure
    with pytest.raises(KeyboardInterrupt):
        contest.run()
    assert (contest.verdict().chosen, contest.verdict().sure) == (1, None)


def test_whoever_comes_to_no_end_is_not_advised() -> None:
    contest, _ = contest_on([[math.inf], [2.0]])
    contest.run()
    assert contest.verdict().chosen == 1
    nobody, _ = contest_on([[math.inf], [math.inf]])
    nobody.run()
    assert nobody.verdict().chosen is None


def test_weighted_means_spread_as_means_do() -> None:
    rng = np.random.default_rng(0)
    ratios = []
    for _ in range(50):
        costs = rng.standard_normal(LEAST_SEEDS)
        error = costs.std(ddof=1) / np.sqrt(LEAST_SEEDS)
        ratios.append(weighted_means([costs.tolist()])[0].std() / error)
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.02)
