"""wrinklebench on a quarter of the sheet: one more line of the scene; what it leaves out its result examines."""

from own import solve
from problem import solve_or_say

if __name__ == "__main__":
    solve_or_say(lambda: solve({"symmetry.reduce": "quarter"}))
