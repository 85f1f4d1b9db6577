"""wrinklebench itself, answering as its peers do, with the limits that its result gives beside the values."""

from problem import answer, asked, solve_or_say

from cases import load_scene, run
from cases.errors import errors_of
from cases.machine import code

METHODS = {"annulus": "tension-field", "hole": "tension-field", "stretch": "koiter"}
NAMES = {
    "annulus": {"energy_N_mm": "energy_N_mm.total", "torque_N_mm": "reactions.inner.moment_N_mm.z"},
    "hole": {"energy_N_mm": "energy_N_mm.total", "force_N": "reactions.top.force_N.y"},
    "stretch": {"rms_mm": "sections.midsection.rms_mm"},
}
PROBLEM, NODES = asked()


def solve(changes=None):
    scene = load_scene(PROBLEM, changes or {})
    solution = run(scene, METHODS[PROBLEM], nodes=NODES)
    if solution.status.value != "converged":
        raise ArithmeticError(solution.message)
    found = {error.quantity: error for error in errors_of(solution, scene)}
    names = NAMES[PROBLEM]
    values = {name: found[quantity].value for name, quantity in names.items()}
    limits = {name: found[quantity].limit for name, quantity in names.items()}
    components = 2 if PROBLEM == "hole" else 3
    unknowns = components * int(solution.levels[-1]["nodes"])  # of the part that is solved
    versions = {"wrinklebench": f"{code()['version'] or 'source'} {code()['source_sha256'][:8]}"}
    answer(values, solution.cpu_seconds, unknowns, solution.steps, versions, limits)


if __name__ == "__main__":
    solve_or_say(solve)
