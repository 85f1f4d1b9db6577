"""The measures of the verification runs on numbers with known answers."""

from __future__ import annotations

import numpy as np
import pytest

from tests.benchmarks.tables import extrapolated, observed_order, relative_l2

SPACING = np.array([0.4, 0.2, 0.1])


def test_order_of_a_power():
    assert observed_order(SPACING, 3.0 * SPACING**1.7) == pytest.approx(1.7, rel=1e-12)


@pytest.mark.parametrize("order", [1.0, 2.0])
def test_extrapolation_removes_an_error_of_its_order(order):
    value = 5.0 - 3.0 * SPACING**order
    assert extrapolated(SPACING, value, order) == pytest.approx(5.0, rel=1e-12)


def test_relative_l2():
    exact = np.array([3.0, 4.0])
    assert relative_l2(exact, exact) == 0.0
    assert relative_l2(np.array([3.0, 5.0]), exact) == pytest.approx(0.2, rel=1e-12)
