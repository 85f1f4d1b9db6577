"""CalculiX: the stretched strip as quadratic shells, which it turns into quadratic bricks with one layer.

Poisson's ratio is 0.49: the bricks are of a material in three dimensions, which 0.5 would make incompressible.
"""

import subprocess
import tempfile
from pathlib import Path

import numpy as np
from problem import HEIGHT, PULL, STRETCH, answer, asked, rms_of, solve_or_say, strip_lattice, waves

_, MESH = asked()
ITSELF = "ccx"


def numbers(values):
    """Sixteen numbers in a line, as the input format wants it."""
    values = [str(int(value) + 1) for value in values]
    return "\n".join(", ".join(values[k : k + 16]) for k in range(0, len(values), 16))


def deck():
    lattice = strip_lattice(MESH)
    points, cells = lattice.points(), lattice.quadratic()[:, :8]
    used = np.unique(cells)
    height = 0.02 * waves(points)  # a stress-free imperfection instead of a start
    lines = ["*NODE"]
    lines += [f"{k + 1}, {points[k, 0]:.12g}, {points[k, 1]:.12g}, {height[k]:.12g}" for k in used]
    lines += ["*ELEMENT, TYPE=S8R, ELSET=SHEET"]
    lines += [f"{k + 1}, {', '.join(str(node + 1) for node in cell)}" for k, cell in enumerate(cells)]
    for name, side in (("BOTTOM", -1), ("TOP", 1)):
        edge = [k for k in used if np.isclose(points[k, 1], side * HEIGHT / 2)]
        lines += [f"*NSET, NSET={name}", numbers(edge)]
    line = [k for k in used if np.isclose(points[k, 1], 0.0)]
    lines += ["*NSET, NSET=LINE", numbers(line)]
    lines += ["*MATERIAL, NAME=RUBBER", "*ELASTIC", f"{STRETCH.young}, 0.49"]
    lines += ["*SHELL SECTION, ELSET=SHEET, MATERIAL=RUBBER", f"{STRETCH.thickness}"]
    lines += ["*BOUNDARY", "BOTTOM, 1, 3", "TOP, 1, 1", "TOP, 3, 3"]
    lines += ["*STEP, NLGEOM, INC=400", "*STATIC", "0.1, 1.0, 1e-5, 0.1"]
    lines += ["*BOUNDARY", f"TOP, 2, 2, {PULL}"]
    lines += ["*NODE PRINT, NSET=LINE, FREQUENCY=1000", "U"]
    lines += ["*NODE PRINT, NSET=TOP, TOTALS=ONLY, FREQUENCY=1000", "RF", "*END STEP", ""]
    return "\n".join(lines), points, height, 3 * used.size


def solve():
    text, points, height, unknowns = deck()
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "strip.inp").write_text(text)
        before = resource_seconds()
        done = subprocess.run([ITSELF, "-i", "strip"], cwd=folder, capture_output=True, text=True)
        spent = resource_seconds() - before
        printed = (Path(folder) / "strip.dat").read_text()
        steps = (Path(folder) / "strip.sta").read_text().splitlines()[2:]
    if done.returncode or "*ERROR" in done.stdout or not printed.strip():
        said = [line.strip() for line in done.stdout.splitlines() if "*ERROR" in line]
        raise ArithmeticError(said[0] if said else f"stopped after {len(steps)} increments")
    rows = [line.split() for line in printed.splitlines()]
    heights = {int(r[0]) - 1: float(r[3]) for r in rows if len(r) == 4 and r[0].isdigit()}
    nodes = sorted(heights, key=lambda k: points[k, 0])
    total = next(rows[k + 2] for k, r in enumerate(rows) if r[:2] == ["total", "force"])
    values = {
        "force_N": float(total[1]),
        "rms_mm": rms_of(points[nodes, 0], np.array([heights[k] + height[k] for k in nodes])),
    }
    version = subprocess.run([ITSELF, "-v"], capture_output=True, text=True).stdout.split()[-1]
    answer(values, spent, unknowns, sum(int(line.split()[3]) for line in steps), {"ccx": version})


def resource_seconds():
    """CPU seconds of the programs that were called."""
    import resource

    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    solve_or_say(solve)
