"""The smooth curve: against least squares, against its own claims."""

from __future__ import annotations

import numpy as np
import pytest

from simmpp.studies.curve import smooth as module
from simmpp.studies.curve.smooth import smooth

X = np.linspace(0.05, 0.95, 10)


def test_without_a_process_it_is_the_line_of_least_squares(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "HEIGHTS", (1e-9,))
    monkeypatch.setattr(module, "NOISES", (0.1,))
    monkeypatch.setattr(module, "LINE_VARIANCE", 1e6)
    y = 0.3 - 1.2 * X + 0.1 * np.random.default_rng(0).standard_normal(len(X))
    wanted = np.array([0.0, 0.37, 1.0])
    mean, error = smooth(X, y, wanted)
    design = np.column_stack([np.ones(len(X)), X])
    covariance = 0.1**2 * np.linalg.inv(design.T @ design)
    at = np.column_stack([np.ones(3), wanted])
    np.testing.assert_allclose(mean, at @ np.linalg.lstsq(design, y)[0], atol=1e-6)
    np.testing.assert_allclose(error, np.sqrt(np.diag(at @ covariance @ at.T)), rtol=1e-4)


def test_without_noise_it_goes_through_the_points(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "NOISES", (1e-5,))
    y = np.exp(-3 * X)
    mean, error = smooth(X, y, X)
    np.testing.assert_allclose(mean, y, atol=1e-4)
    assert error.max() < 1e-4


def test_it_is_nearer_than_the_points_and_knows_how_near() -> None:
    random, truth = np.random.default_rng(1), np.exp(-X)
    errors, claims = [], []
    for _ in range(60):
        mean, error = smooth(X, truth + random.normal(0, 0.04, len(X)), X)
        errors.append(mean - truth)
        claims.append(error)
    assert np.sqrt(np.mean(np.square(errors))) < 0.7 * 0.04
    covered = np.abs(errors) <= 1.96 * np.array(claims)
    assert 0.90 < covered.mean() < 0.99


def test_a_constant_added_is_added_and_order_does_not_matter() -> None:
    y = np.random.default_rng(2).normal(0, 0.1, len(X))
    mean, error = smooth(X, y, X)
    turned, same = smooth(X[::-1], y[::-1] + 5, X)
    np.testing.assert_allclose(turned, mean + 5, atol=1e-9)
    np.testing.assert_allclose(same, error, rtol=1e-6)
