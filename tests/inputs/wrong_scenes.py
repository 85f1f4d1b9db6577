"""Wrong scenes and the exact sentences that they earn, one row per mistake.

A row is (name, TOML text, sentences); sentences without the leading file name.
"""

from __future__ import annotations

SHEET = 'sheet.shape = "{}"\nedges.left.support = "pinned"\n'
PLATE = SHEET.format("rectangle")
HOLED = SHEET.format("rectangle-with-hole")
RING = 'sheet.shape = "annulus"\nedges.inner.support = "pinned"\n'

WRONG_SCENES = [
    (
        "empty file",
        "",
        [
            'edges: no edge is supported; give "pinned" or "clamped" to at least one of "left", "right",'
            ' "bottom" or "top"'
        ],
    ),
    (
        "unknown table, alike",
        RING + "[solvr]\n",
        ['solvr = a table: unknown key; did you mean "solver"?'],
    ),
    (
        "unknown table, like nothing",
        RING + "[xyzzy]\n",
        [
            "xyzzy = a table: unknown key; allowed are title, name, sheet, material, start, effects, symmetry,"
            " mesh, solver, edges, sections, paths"
        ],
    ),
    (
        "unknown key, alike",
        RING + "material.poison = 0.3\n",
        ['material.poison = 0.3: unknown key; did you mean "poisson"?'],
    ),
    (
        "unknown key that belongs to another table",
        RING + "mesh.young_MPa = 3\n",
        ['mesh.young_MPa = 3: unknown key here; did you mean "material.young_MPa"?'],
    ),
    (
        "key of another shape",
        PLATE + "sheet.outer_radius_mm = 250\n",
        ["sheet.outer_radius_mm = 250: unknown key; allowed are thickness_mm, shape, width_mm, height_mm"],
    ),
    (
        "unknown shape",
        "sheet.shape = 'anulus'\nedges.inner.support = 'pinned'\n",
        [
            'sheet.shape = "anulus": must be "rectangle", "annulus" or "rectangle-with-hole";'
            ' did you mean "annulus"?'
        ],
    ),
    (
        "unknown shape beside other mistakes",
        "sheet = {shape = 7, thickness_mm = -1}\nedges.inner.support = 'pinned'\n",
        [
            'sheet.shape = 7: must be "rectangle", "annulus" or "rectangle-with-hole"',
            "sheet.thickness_mm = -1: must be a length in mm from 1e-6 to 1e9; the nearest is 1e-06",
        ],
    ),
    (
        "hole wider than the sheet",
        HOLED + "sheet.hole_radius_mm = 30\n",
        [
            "sheet.hole_radius_mm = 30.0: the hole is wider than the sheet; the radius must be below 25,"
            " half the shorter side"
        ],
    ),
    (
        "rings inside out",
        RING + "sheet.inner_radius_mm = 300\n",
        ["sheet.inner_radius_mm = 300.0: must be below sheet.outer_radius_mm, which is 250"],
    ),
    (
        "equal radii",
        RING + "sheet.inner_radius_mm = 250\n",
        ["sheet.inner_radius_mm = 250.0: must be below sheet.outer_radius_mm, which is 250"],
    ),
    (
        "a thread",
        PLATE + "sheet.width_mm = 0.1\n",
        ["sheet: is 2.54e+03 times longer than its narrowest width; at most 1000 times"],
    ),
    (
        "a block",
        PLATE + "sheet.thickness_mm = 200\n",
        ["sheet.thickness_mm = 200.0: must be below the narrowest width of the sheet, 101.6 mm"],
    ),
    (
        "no size",
        PLATE + "sheet.width_mm = 0\n",
        ["sheet.width_mm = 0: must be a length in mm from 1e-6 to 1e9; the nearest is 1e-06"],
    ),
    (
        "infinite size",
        PLATE + "sheet.width_mm = inf\n",
        ["sheet.width_mm = inf: must be a length in mm from 1e-6 to 1e9"],
    ),
    (
        "poisson too large",
        RING + "material.poisson = 0.7\n",
        ["material.poisson = 0.7: must be a number above -1 and at most 0.5; the nearest is 0.5"],
    ),
    (
        "poisson too small",
        RING + "material.poisson = -1\n",
        ["material.poisson = -1: must be a number above -1 and at most 0.5"],
    ),
    (
        "poisson not a number",
        RING + "material.poisson = nan\n",
        ["material.poisson = nan: must be a number above -1 and at most 0.5"],
    ),
    (
        "no stiffness",
        RING + "material.young_MPa = 0.0\n",
        ["material.young_MPa = 0.0: must be a modulus in MPa from 1e-9 to 1e9; the nearest is 1e-09"],
    ),
    (
        "text for a number",
        RING + 'material.young_MPa = "3.5 GPa"\n',
        ['material.young_MPa = "3.5 GPa": must be a modulus in MPa from 1e-9 to 1e9'],
    ),
    (
        "true for a number",
        RING + "material.young_MPa = true\n",
        ["material.young_MPa = true: must be a modulus in MPa from 1e-9 to 1e9"],
    ),
    (
        "one node",
        RING + "mesh.nodes = 1\n",
        ["mesh.nodes = 1: must be a whole number from 400 to 50000000; the nearest is 400"],
    ),
    (
        "a billion nodes",
        RING + "mesh.nodes = 1_000_000_000\n",
        ["mesh.nodes = 1000000000: must be a whole number from 400 to 50000000; the nearest is 50000000"],
    ),
    (
        "half a node",
        RING + "mesh.nodes = 1000.5\n",
        ["mesh.nodes = 1000.5: must be a whole number from 400 to 50000000"],
    ),
    (
        "bias out of range",
        RING + "mesh.bias = 6\n",
        ["mesh.bias = 6: must be a number from 0 (uniform) to 5; the nearest is 5.0"],
    ),
    (
        "unknown support",
        "sheet.shape = 'annulus'\nedges.inner.support = 'pined'\n",
        ['edges.inner.support = "pined": must be "free", "pinned" or "clamped"; did you mean "pinned"?'],
    ),
    (
        "unknown edge",
        RING + "edges.outter.support = 'pinned'\n",
        [
            'edges.outter: an annulus has no such edge; its edges are "inner" or "outer"; did you mean "outer"?'
        ],
    ),
    (
        "edge of another shape",
        PLATE + "edges.inner.support = 'pinned'\n",
        [
            'edges.inner: a rectangle has no such edge; its edges are "left", "right", "bottom" or "top"',
        ],
    ),
    (
        "move of a free edge",
        RING + "edges.outer.move_mm = [1, 0, 0]\n",
        [
            "edges.outer.move_mm = [1.0, 0.0, 0.0]: a free edge cannot be moved; set edges.outer.support to"
            ' "pinned" or "clamped"'
        ],
    ),
    (
        "turn of a free edge",
        RING + "edges.outer.rotate_deg = 3\n",
        [
            "edges.outer.rotate_deg = 3.0: a free edge cannot be moved; set edges.outer.support to"
            ' "pinned" or "clamped"'
        ],
    ),
    (
        "no supported edge",
        "sheet.shape = 'annulus'\n[edges.inner]\n[edges.outer]\n",
        ['edges: no edge is supported; give "pinned" or "clamped" to at least one of "inner" or "outer"'],
    ),
    (
        "move with two components",
        RING + "edges.inner.move_mm = [0, 1]\n",
        [
            "edges.inner.move_mm = [0, 1]: must be three finite numbers in mm, [x, y, z],"
            " each from -1e9 to 1e9"
        ],
    ),
    (
        "move to infinity",
        RING + "edges.inner.move_mm = [0, 0, inf]\n",
        [
            "edges.inner.move_mm = [0, 0, inf]: must be three finite numbers in mm, [x, y, z],"
            " each from -1e9 to 1e9"
        ],
    ),
    (
        "move far beyond the sheet",
        RING + "edges.inner.move_mm = [0, 0, 1e6]\n",
        ["edges.inner.move_mm = [0.0, 0.0, 1000000.0]: must be no longer than 50000 mm, 100 times the sheet"],
    ),
    (
        "growth of a straight edge",
        PLATE + "edges.left.grow_mm = 1\n",
        ["edges.left.grow_mm = 1.0: only a circular edge can grow; move a straight edge by move_mm"],
    ),
    (
        "a circle that closes",
        RING + "edges.inner.grow_mm = -62.5\n",
        [
            "edges.inner.grow_mm = -62.5: must be above -62.5, where the circle closes, and at most 50000",
        ],
    ),
    (
        "edges that part at their corner",
        PLATE + "edges.top = {support = 'pinned', move_mm = [0, 1, 0]}\n",
        ["edges.left: the edges left and top take their common corner to places 1 mm apart"],
    ),
    (
        "edges as a value",
        "edges = 'pinned'\n",
        [
            'edges = "pinned": must be tables, as in [edges.NAME]',
            'edges: no edge is supported; give "pinned" or "clamped" to at least one of "left", "right",'
            ' "bottom" or "top"',
        ],
    ),
    (
        "table as a value",
        RING + "mesh = 20000\n",
        ["mesh = 20000: must be a table, as in [mesh]"],
    ),
    (
        "effect switched by a truth value",
        RING + "effects.bending = false\n",
        ['effects.bending = false: must be "auto", "on" or "off"'],
    ),
    (
        "unknown kinematics",
        RING + "effects.kinematics = 'foeppl'\n",
        ['effects.kinematics = "foeppl": must be "finite" or "moderate"'],
    ),
    (
        "symmetry that the shape does not have",
        PLATE + "symmetry.reduce = 'sector:6'\n",
        [
            'symmetry.reduce = "sector:6": only an annulus can be reduced so; a rectangle allows "none",'
            ' "half-x", "half-y" or "quarter"'
        ],
    ),
    (
        "sector without a number",
        RING + "symmetry.reduce = 'sector'\n",
        [
            'symmetry.reduce = "sector": must be "none", "half-x", "half-y", "quarter", "axisymmetric" or'
            ' "sector:N", N from 1 to 9999; did you mean "sector:6"?'
        ],
    ),
    (
        "unknown damping",
        RING + "solver.damping = 'kinetik'\n",
        [
            'solver.damping = "kinetik": must be "adaptive", "kinetic", "kinetic-published" or "viscous";'
            ' did you mean "kinetic"?'
        ],
    ),
    (
        "tolerance of nothing",
        RING + "solver.tolerance = 0\n",
        ["solver.tolerance = 0: must be a residual from 1e-14 to 0.1; the nearest is 1e-14"],
    ),
    (
        "no time",
        RING + "solver.max_seconds = -1\n",
        ["solver.max_seconds = -1: must be a positive number of seconds, at most 1e8"],
    ),
    (
        "mode without a number",
        RING + "start.from = 'mode:first'\n",
        [
            'start.from = "mode:first": must be a result folder or "mode:N" with N from 1 to 1000;'
            ' the nearest is "mode:1"'
        ],
    ),
    (
        "section with one end",
        PLATE + "sections.middle.from_mm = [0, 0]\n",
        ["sections.middle: a line needs from_mm and to_mm, or radius_mm alone; given: from_mm"],
    ),
    (
        "section with ends and a radius",
        PLATE + "sections.middle = {from_mm = [0, 0], to_mm = [1, 0], radius_mm = 3}\n",
        [
            "sections.middle: a line needs from_mm and to_mm, or radius_mm alone;"
            " given: from_mm, to_mm, radius_mm"
        ],
    ),
    (
        "section without length",
        PLATE + "sections.middle = {from_mm = [1, 1], to_mm = [1, 1]}\n",
        ["sections.middle: the line has no length"],
    ),
    (
        "section off the sheet",
        PLATE + "sections.middle = {from_mm = [0, 0], to_mm = [60, 0]}\n",
        [
            "sections.middle: the point [60, 0] is off the sheet, which reaches 50.8 mm along x and"
            " 127 mm along y"
        ],
    ),
    (
        "path through the hole",
        HOLED + "paths.across = {from_mm = [-25, 0], to_mm = [25, 0]}\n",
        ["paths.across: the line crosses the hole of radius 15 mm about the origin"],
    ),
    (
        "circle off the sheet",
        RING + "sections.ring.radius_mm = 20\n",
        ["sections.ring: the circle leaves the sheet; allowed are radii from 62.5 to 250 mm"],
    ),
    (
        "name that is no file name",
        PLATE + 'sections."../up" = {from_mm = [0, 0], to_mm = [1, 0]}\n',
        [
            'sections."../up" = a table: the name must be of letters, digits, - and _, at most 64 of them',
        ],
    ),
    (
        "title with an escape sequence",
        RING + 'title = "\\u001b[2J"\n',
        ['title = "\\u001b[2J": must be one line of text, at most 200 characters'],
    ),
    (
        "many mistakes at once",
        "sheet = {shape = 'annulus', inner_radius_mm = 300, thicknes_mm = 1}\n"
        "material = {young_MPa = -1, poisson = 0.7}\n"
        "edges.outer.move_mm = [1, 0, 0]\nmesh.nodes = 3\n",
        [
            'sheet.thicknes_mm = 1: unknown key; did you mean "thickness_mm"?',
            "material.young_MPa = -1: must be a modulus in MPa from 1e-9 to 1e9; the nearest is 1e-09",
            "material.poisson = 0.7: must be a number above -1 and at most 0.5; the nearest is 0.5",
            "mesh.nodes = 3: must be a whole number from 400 to 50000000; the nearest is 400",
            "edges.outer.move_mm = [1.0, 0.0, 0.0]: a free edge cannot be moved; set edges.outer.support to"
            ' "pinned" or "clamped"',
            'edges: no edge is supported; give "pinned" or "clamped" to at least one of "inner" or "outer"',
        ],
    ),
]
