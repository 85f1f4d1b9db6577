"""Limits of made sequences of meshes: exact powers, higher-order terms, noise, and what must be refused."""

from __future__ import annotations

import numpy as np
import pytest

from cases.mesh_sequence import SAFETY, mesh_limit

NODES = (3783, 7511, 15015, 29890)
WIDTH = np.array(NODES) ** -0.5


@pytest.mark.parametrize("order", [0.7, 1.0, 2.0, 3.5])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_exact_power_gives_its_limit_and_order_on_unequal_meshes(order: float, sign: float) -> None:
    found = mesh_limit(NODES, 5.0 + sign * 3.0 * WIDTH**order)
    assert found.refused == ""
    assert found.value == pytest.approx(5.0, rel=1e-9)
    assert found.order == pytest.approx(order, rel=1e-6)
    # of an exact power the band is the safety factor times the finest mesh's true error
    assert found.band == pytest.approx(SAFETY * 3.0 * WIDTH[-1] ** order, rel=1e-6)
    assert found.error_of_finest == pytest.approx(found.band, rel=1e-12)


@pytest.mark.parametrize("count", [3, 4])
def test_the_true_limit_lies_in_the_band_of_a_smooth_scheme(count: int) -> None:
    """Errors h^2 + c h^4, relative to the coarsest: the band holds the truth."""
    h = WIDTH[-count:] / WIDTH[-count]
    for c in (-0.2, 0.3, 1.0, 3.0):
        found = mesh_limit(NODES[-count:], 2.0 + h**2 + c * h**4)
        assert found.refused == ""
        assert abs(found.value - 2.0) <= found.band


def test_a_fourth_mesh_widens_the_band_where_the_order_drifts() -> None:
    h = WIDTH / WIDTH[0]
    values = 2.0 + h**2 + 4.0 * h**5
    assert mesh_limit(NODES, values).band >= mesh_limit(NODES[1:], values[1:]).band
    assert mesh_limit(NODES, values).value == mesh_limit(NODES[1:], values[1:]).value


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ([1.0, 1.1, 1.05], "oscillate"),
        ([1.0, 1.1, 1.1], "oscillate"),
        ([1.0, 1.1, 1.3], "do not converge"),
        ([1.0, 1.1, 1.2], "do not converge"),
        ([0.0, 1.0, 1.001], "do not converge"),
    ],
)
def test_what_does_not_approach_a_limit_is_refused(values: list[float], reason: str) -> None:
    found = mesh_limit(NODES[:3], values)
    assert reason in found.refused
    assert found.order is None
    assert found.value == found.finest == values[-1]
    assert found.band == found.error_of_finest == pytest.approx(max(values) - min(values))


def test_values_that_agree_have_no_error_to_observe() -> None:
    found = mesh_limit(NODES, [2.5] * 4)
    assert (found.value, found.order, found.band, found.refused) == (2.5, None, 0.0, "")


def test_noise_of_a_hundredth_of_the_error_moves_the_limit_by_about_as_much() -> None:
    h = WIDTH / WIDTH[0]
    random = np.random.default_rng(5)
    inside = 0
    for _ in range(200):
        found = mesh_limit(NODES, 1.0 + h**2 + 1e-3 * random.standard_normal(4))
        inside += not found.refused and abs(found.value - 1.0) <= found.band
    # the last two meshes differ by 0.12, so 0.001 of noise is a hundredth of what the limit is made from
    assert inside >= 190


@pytest.mark.parametrize(
    ("nodes", "values", "sentence"),
    [
        ([1000, 4000], [1.0, 2.0], "at least three meshes"),
        ([1000, 4000, 16000], [1.0, 2.0], "at least three meshes"),
        ([1000, 4000, 16000], [1.0, 2.0, np.nan], "finite"),
        ([4000, 1000, 16000], [1.0, 2.0, 3.0], "times as fine"),
        ([1000, 1100, 16000], [1.0, 2.0, 3.0], "times as fine"),
        ([0, 1100, 16000], [1.0, 2.0, 3.0], "positive"),
    ],
)
def test_broken_sequences_are_refused(nodes: list[float], values: list[float], sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        mesh_limit(nodes, values)
