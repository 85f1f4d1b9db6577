from __future__ import annotations

import numpy as np
import pytest

from reports.surface import View, flat_view, lit_view

RED, BLUE = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def square(z: np.ndarray | float = 0.0) -> np.ndarray:
    x, y = np.meshgrid(np.linspace(0, 10, 6), np.linspace(0, 10, 6), indexing="ij")
    return np.stack([x, y, np.broadcast_to(z, x.shape)], axis=-1)


def test_flat_view_keeps_colours_places_and_size():
    rgb = np.broadcast_to(RED, (5, 5, 3)).copy()
    rgb[:, 3:] = BLUE  # the upper part, y > 6
    picture = flat_view(square(), rgb, False, pixels=100)
    left, right, bottom, top = picture.extent
    assert (left, right, bottom, top) == pytest.approx((-0.1, 10.1, -0.1, 10.1), abs=0.11)
    rows = picture.rgba.shape[0]
    np.testing.assert_array_equal(picture.rgba[rows // 4, rows // 2], [0, 0, 255, 255])
    np.testing.assert_array_equal(picture.rgba[3 * rows // 4, rows // 2], [255, 0, 0, 255])
    assert picture.rgba[0, 0, 3] == 0.0
    # covered area against the true one; the outline is known to a pixel
    pixel = ((right - left) / picture.rgba.shape[1]) ** 2
    assert picture.rgba[..., 3].sum() / 255 * pixel == pytest.approx(100.0, rel=1e-3)


def test_nearer_surface_hides_the_farther_one_whatever_comes_first():
    folded = square()
    folded[3:, :, 0] = 10.0 - folded[3:, :, 0]  # comes back over itself
    for height, seen in ((1.0, BLUE), (-1.0, RED)):
        folded[3:, :, 2] = height
        rgb = np.broadcast_to(RED, (5, 5, 3)).copy()
        rgb[3:] = BLUE
        picture = flat_view(folded, rgb, False, pixels=100)
        rows, columns = picture.rgba.shape[:2]
        np.testing.assert_array_equal(picture.rgba[rows // 2, columns // 4, :3], 255 * seen)


def test_closed_mesh_has_no_gap():
    angle = -2 * np.pi * np.arange(64) / 64
    radius = np.linspace(5.0, 10.0, 8)
    r = np.stack(
        [np.outer(np.cos(angle), radius), np.outer(np.sin(angle), radius), np.zeros((64, 8))], axis=-1
    )
    rgb = np.ones((64, 7, 3))
    picture = flat_view(r, rgb, True, pixels=200)
    pixel = ((picture.extent[1] - picture.extent[0]) / picture.rgba.shape[1]) ** 2
    # a polygon of 64 sides is 0.16 % smaller than the ring
    assert picture.rgba[..., 3].sum() / 255 * pixel == pytest.approx(np.pi * 75.0, rel=4e-3)


def test_slope_towards_the_light_is_brighter():
    x = square()[..., 0]
    rgb = np.full((5, 5, 3), 0.5)
    towards = lit_view(square(0.5 * x), rgb, False, View(), 60).rgba  # faces the upper left
    away = lit_view(square(-0.5 * x), rgb, False, View(), 60).rgba
    assert int(towards[30, 30, 0]) > int(away[30, 30, 0]) + 50


def test_both_faces_are_lit_alike():
    rgb = np.full((5, 5, 3), 0.5)
    wave = square(np.sin(square()[..., 0]))
    seen = lit_view(wave, rgb, False, View(), 60).rgba
    turned = lit_view(wave[:, ::-1], rgb, False, View(), 60).rgba  # the same sheet, normals reversed
    # triangles are cut the other way
    np.testing.assert_allclose(seen.astype(int), turned.astype(int), atol=5)


@pytest.mark.parametrize(("azimuth", "elevation"), [(-90.0, 90.0), (-70.0, 38.0), (10.0, 0.0)])
def test_view_axes_are_a_right_handed_frame(azimuth, elevation):
    axes = View(azimuth, elevation).axes()
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1.0)


def test_view_from_above_has_x_to_the_right_and_y_up():
    np.testing.assert_allclose(View().axes(), np.eye(3), atol=1e-15)


def test_picture_is_filled_once_and_others_are_not_mistaken_for_it():
    rgb = np.broadcast_to(RED, (5, 5, 3))
    first = flat_view(square(), rgb, False, pixels=60)
    assert flat_view(square(), rgb, False, pixels=60) is first
    for other in (flat_view(square(), rgb, False, pixels=61), flat_view(2 * square(), rgb, False, pixels=60)):
        assert other is not first
    assert (flat_view(square(), rgb[..., ::-1], False, pixels=60).rgba[30, 30] == [0, 0, 255, 255]).all()
