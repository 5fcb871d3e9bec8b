"""When little is left: rounds may be over in another order than they say what is left."""

from __future__ import annotations

import numpy as np

from simmpp.engine.tables.residuals import times_of_residuals

LEFT = np.array([0.5, 0.1, 0.05, 0.009])


def test_all_rounds_up_to_the_first_with_little_left_have_to_be_over() -> None:
    found = times_of_residuals(LEFT, np.array([30, 20, 40, 35]))
    assert found == {"residual_tenth_ps": 30, "residual_hundredth_ps": 40}


def test_what_is_not_reached_or_not_known_is_not_told() -> None:
    assert times_of_residuals(LEFT, np.array([30, -1, 40, -1])) == {}
    assert times_of_residuals(LEFT, np.array([30, 20, -1, -1])) == {"residual_tenth_ps": 30}
    assert times_of_residuals(np.zeros(0), np.array([7])) == {}
