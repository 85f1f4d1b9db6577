"""wrinklebench itself, answering as its peers do."""

from problem import answer, asked, solve_or_say

from cases import load_scene, run
from cases.machine import code

METHODS = {"annulus": "tension-field", "hole": "tension-field", "stretch": "koiter"}
PROBLEM, NODES = asked()


def solve():
    scene = load_scene(PROBLEM)
    solution = run(scene, METHODS[PROBLEM], nodes=NODES)
    if solution.status.value != "converged":
        raise ArithmeticError(solution.message)
    values = {"energy_N_mm": solution.energy_N_mm["total"]}
    if PROBLEM == "annulus":
        values["torque_N_mm"] = float(solution.reactions["inner"].moment_N_mm[2])
    else:
        values["force_N"] = float(solution.reactions["top"].force_N[1])
    if PROBLEM == "stretch":
        from cases.probe import measure_section, sample_section

        section = sample_section(solution.grid, solution.r, scene.sections["midsection"])
        values["rms_mm"] = measure_section(section, scene.sheet.thickness_mm).rms_mm
    unknowns = solution.grid.nodes * (2 if PROBLEM == "hole" else 3)
    versions = {"wrinklebench": f"{code()['version'] or 'source'} {code()['source_sha256'][:8]}"}
    answer(values, solution.cpu_seconds, unknowns, solution.steps, versions)


if __name__ == "__main__":
    solve_or_say(solve)
