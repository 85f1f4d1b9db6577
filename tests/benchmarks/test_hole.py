"""The sheet with a hole (section 4.3 of the paper, Fig. 7-8)."""

from __future__ import annotations

import numpy as np

from cases import load_scene, run
from tests.benchmarks.tables import extrapolated, path_table

MESHES = (10000, 20000, 40000)
# distances from the hole's edge at which the path values are extrapolated, mm
ALONG_X_MM = (1.0, 3.0, 6.0)
ALONG_Y_MM = (20.0, 27.5, 35.0)  # beyond the slack sheet above the hole, whose stretch is not unique


def test_tension_field_balances_and_converges(verify):
    """Hole at 10 %, tension field: equal pulls at top and bottom; path values on three meshes"""
    values, spacings = [], []
    for nodes in MESHES:
        folder = verify.folder(f"hole-tension-field-{nodes}")
        solution = run(load_scene("hole"), method="tension-field", nodes=nodes, out=folder)
        verify.equal(f"status at {nodes}", solution.status.value, "converged", "else no equilibrium to judge")
        verify.below(f"residual at {nodes}", solution.residual, limit=1e-8, reason="the scene's tolerance")
        top, bottom = solution.reactions["top"].force_N, solution.reactions["bottom"].force_N
        verify.below(
            f"relative difference of the pulls at top and bottom at {nodes}",
            float(np.linalg.norm(top + bottom) / np.linalg.norm(top)),
            limit=1e-6,
            reason="the residuals of all free nodes may add up to about residual x sqrt(nodes) cells' force",
        )
        x, y = path_table(folder, "along_x"), path_table(folder, "along_y")
        slack = int(np.count_nonzero(np.interp(ALONG_Y_MM, y.s_mm, y.state) < 1.0))
        verify.equal(f"points compared that are slack at {nodes}", slack, 0, "a slack stretch is not unique")
        verify.note(
            f"largest distance of a slack zone above the hole at {nodes}", y.s_mm[y.state == 0].max(), "mm"
        )
        values.append(
            [*np.interp(ALONG_X_MM, x.s_mm, x.stretch_major), *np.interp(ALONG_Y_MM, y.s_mm, y.stretch_major)]
        )
        spacings.append(1.0 / np.sqrt(solution.grid.nodes))
        verify.note(f"CPU seconds at {nodes}", solution.cpu_seconds, "s")
        verify.note(f"steps at {nodes}", solution.steps)
    spacing, table = np.array(spacings), np.array(values)
    places = [f"along x at {s:g} mm" for s in ALONG_X_MM] + [f"along y at {s:g} mm" for s in ALONG_Y_MM]
    for place, column in zip(places, table.T, strict=True):
        limit = extrapolated(spacing, column)
        verify.note(f"largest stretch {place}, extrapolated", limit)
        verify.below(
            f"largest stretch {place}, difference of 40000 nodes to the extrapolated limit",
            abs(column[-1] - limit) / limit,
            limit=1e-3,
            reason="a hundredth of the pull of 10 %: what the figures resolve",
        )
