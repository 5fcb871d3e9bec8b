"""The model over a grid: conservation, limits, and a slow transcription of the equations."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simmpp.common.errors import ConfigError
from simmpp.model.analytical import Rays, analytical, grouped, imbalances
from simmpp.model.border import border_terms, borders, claims
from simmpp.model.costs import Costs

T3E = Costs(4e6, 10e6, 20e6, 31e3, 31e3, 5e5, 5e5, 5e5, 5e5, 6e6, 2e5, 1e5)
PLAIN = Costs(ray=4.0, sending=10.0, receipt=20.0, pack_object=1.0, pack_ray=0.5)


def permanent(rays: float, steps: int) -> Rays:
    """``rays`` that all need ``steps`` tests: a permanent regime that ends at once."""
    ended = np.zeros(steps)
    ended[-1] = rays
    return Rays(np.full(steps, float(rays)), ended, np.ones(steps))


def geometric(rays: float, mean_steps: float, least: float = 0.5) -> Rays:
    """Rays that end after each step with probability 1 / ``mean_steps``: decay from the start.

    The series is cut where fewer than ``least`` rays are left.
    """
    stays = 1.0 - 1.0 / mean_steps
    last = int(np.log(least / rays) / np.log(stays)) if stays > 0 and least < rays else 0
    tests = np.asarray(rays * stays ** np.arange(last + 1), np.float64)
    return Rays(tests, tests - np.append(tests[1:], 0.0), np.ones(last + 1))


def border_without_imbalance(costs: Costs, processors: np.ndarray, rays: Rays) -> np.ndarray:
    """The x at which TC = TO, with zeta = 0: (B,), below 0 where object dataflow always wins."""
    message, saved = border_terms(costs)
    if saved <= 0:
        return np.full(len(processors), -np.inf)
    nb = np.asarray(processors, np.float64)
    return 1.0 - nb * (nb - 1) * message / (rays.mean_tests * saved)


def transcribed(
    costs: Costs, nb: int, x: float, tests: np.ndarray, ended: np.ndarray, z: np.ndarray
) -> tuple[float, float]:
    """Equations (1) and (2), TO and TC with loops over PEs as printed."""
    p = (1 - x) / (nb - 1)
    pes = range(nb)

    def r(n: list[float], k: int) -> list[list[float]]:
        rows = []
        for i in pes:
            row = [p * n[i] * (1 + z[k][j]) for j in pes]
            row[i] = x * n[i] * (1 + (1 - x) / (x * (nb - 1)) * z[k][i])
            rows.append(row)
        return rows

    total_object = total_ray = 0.0
    before = [tests[0] / nb] * nb
    for k in range(len(tests)):
        even = [tests[k] / nb] * nb
        lost = [ended[k] / nb] * nb
        rk = r(even, k)
        assert sum(map(sum, rk)) == pytest.approx(tests[k])  # equation (5)
        times = []
        for i in pes:
            asked = sum(rk[i][j] for j in pes if j != i)
            served = sum(rk[j][i] for j in pes if j != i)
            times.append(
                even[i] * costs.ray
                + lost[i] * costs.deletion
                + (costs.sending + costs.pack_request + costs.receipt + costs.unpack_object) * asked
                + (costs.sending + costs.pack_object + costs.receipt + costs.unpack_request)
                * served
            )
        total_object += max(times)
        survive = tests[k] / sum(before)
        rk = r([n * survive for n in before], k)
        n = [sum(rk[j][i] for j in pes) for i in pes]  # equation (2)
        times = [
            n[i] * costs.ray
            + n[i] / tests[k] * ended[k] * costs.deletion
            + (nb - 1) * (costs.sending + costs.receipt + costs.pack_message + costs.unpack_message)
            + costs.pack_ray * sum(rk[i][j] for j in pes if j != i)
            + costs.unpack_ray * sum(rk[j][i] for j in pes if j != i)
            for i in pes
        ]
        total_ray += max(times)
        before = n
    return total_object, total_ray


@given(st.integers(2, 9), st.floats(0.0, 1.0), st.sampled_from([0.0, 0.3, 1.0]), st.integers(0, 99))
def test_equals_the_printed_equations(nb: int, x: float, imbalance: float, seed: int) -> None:
    rays, held = geometric(500.0, 3.0), max(x, 1 / nb)
    z = imbalances(len(rays.tests), nb, imbalance, seed)
    expected = transcribed(T3E, nb, held, rays.tests, rays.ended, z)
    found = analytical(T3E, [nb], [x], rays, imbalance=imbalance, seed=seed)
    assert (found.object[0, 0], found.ray[0, 0]) == pytest.approx(expected, rel=1e-9)


@given(st.integers(2, 40), st.floats(0.01, 1.0), st.integers(0, 99))
def test_zeta_keeps_its_range_and_the_number_of_rays(nb: int, amplitude: float, seed: int) -> None:
    z = imbalances(5, nb, amplitude, seed)
    assert np.abs(z).max() <= amplitude
    assert z.sum(axis=1) == pytest.approx(0.0, abs=1e-9)
    x = 1 / nb  # the least that a PE can hold: zeta(i, i, k) is still within [-1, 1]
    own = (1 - x) / (x * (nb - 1)) * z
    assert np.abs(own).max() <= 1.0


def test_with_everything_in_memory_object_dataflow_only_computes() -> None:
    rays = permanent(960.0, 5)
    times = analytical(PLAIN, [8], [1.0], rays)
    assert times.object[0, 0] == pytest.approx(5 * 120 * 4.0)
    assert times.ray[0, 0] == pytest.approx(5 * (120 * 4.0 + 7 * 30.0))  # empty messages


def test_one_processor_lacks_nothing() -> None:
    times = analytical(PLAIN, [1], [0.1, 1.0], permanent(100.0, 2))
    assert (times.object == 800.0).all() and (times.ray == 800.0).all()


@pytest.mark.parametrize("costs", [T3E, PLAIN])
def test_the_border_has_a_closed_form(costs: Costs) -> None:
    rays, nb = geometric(200_000.0, 12.0), np.array([16, 32, 64, 100])
    expected = border_without_imbalance(costs, nb, rays)
    fine = analytical(costs, nb.tolist(), np.linspace(0.0, 1.0, 2001).tolist(), rays)
    inside = expected > 0.1
    assert inside.sum() >= 2
    assert borders(fine)[inside] == pytest.approx(expected[inside], abs=1e-3)


def test_t_ray_has_no_part_in_the_border_without_imbalance() -> None:
    rays = permanent(10_000.0, 4)
    grid = ([8, 64], [0.1, 0.5, 0.9])
    difference = [
        (times.ray - times.object)
        for times in (analytical(PLAIN.scaled("test", f), *grid, rays) for f in (0.0, 1.0, 50.0))
    ]
    assert difference[1] == pytest.approx(difference[0])
    assert difference[2] == pytest.approx(difference[0])


def test_messages_without_rays_are_left_out() -> None:
    rays = permanent(640.0, 1)
    costs = Costs(ray=0.0, sending=1.0, receipt=0.0)

    def messages(kind: str) -> float:
        times = analytical(costs, [64], [0.5], rays, ray_messages=kind)  # type: ignore[arg-type]
        return float(times.ray[0, 0])

    assert messages("to-all") == 63
    assert messages("with-rays") == pytest.approx(63 * (1 - (62 / 63) ** 5))
    assert messages("after-runs") == pytest.approx(0.5 * 63 * (1 - (62 / 63) ** 10))


def test_grouping_keeps_rays_and_steps() -> None:
    rays = geometric(1000.0, 20.0)
    few = grouped(rays, 10)
    assert len(few.tests) == 10
    assert few.repeats.sum() == len(rays.tests)
    assert few.tests @ few.repeats == pytest.approx(rays.tests.sum())
    assert few.mean_tests == pytest.approx(rays.mean_tests)


def test_the_claims_of_figure_2() -> None:
    rays = permanent(100_000.0, 10)
    grid = [x / 20 for x in range(1, 20)]
    once, never_rises = claims(analytical(PLAIN, [8, 64, 128, 200, 256], grid, rays))
    assert once.holds and never_rises.holds
    nothing = claims(analytical(PLAIN, [8], grid, permanent(1e9, 10)))
    assert [each.holds for each in nothing] == [False, False]
    # Where rays are dearer to pack than asking costs, object dataflow wins at every x.
    heavy = Costs(ray=1.0, sending=1.0, receipt=1.0, pack_ray=5.0, unpack_ray=5.0)
    assert np.isneginf(border_without_imbalance(heavy, np.array([8.0]), rays)).all()


def test_a_group_of_costs_that_is_none_is_refused() -> None:
    with pytest.raises(ConfigError, match="startup, packing, object, test"):
        PLAIN.scaled("latency", 2.0)
