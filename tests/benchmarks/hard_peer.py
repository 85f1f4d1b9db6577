"""The hard cases given to a finite-element code: python -m tests.benchmarks.hard_peer --python PEER.

PEER is a Python that has FElupe; the code under test is not in it. Each case is posed as ever, up to the moment at
which the engine would relax: the peer gets mesh, material, supports and start instead, and its answer is judged by the
case's own requirements, with margins for another discretisation. Leaves `hard_peer.json` beside the verification runs.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

from cases.hard import AS_EXPECTED, HardCase, Requirement
from cases.hard_table import hard_cases, read_hard
from fdsolver.level import Level
from fdsolver.relax import State
from fdsolver.result import Solution, Status

FILE = "hard_peer.json"
SCRIPT = Path(__file__).parent / "peers" / "felupe_hard.py"
RIGHT, WRONG, FAILED, CRASHED = "right", "silent wrong answer", "gave up by name", "crashed or no end"
OUTCOMES = (RIGHT, FAILED, CRASHED, WRONG)
MARGIN = 0.01  # of a required value: elements instead of zones, a solid instead of a plate
SAME_ENERGY = {True: 0.05, False: 0.01}  # plate (its edges held by lines of a solid), membrane
SLACK_LEFT = 1e-5  # part of the unrelaxed energy that the peer's slack zones keep
AFFINE = "largest distance from the affine map / width"
NEAR = (
    1e-4  # such a distance: Newton's method stops by its forces, and cells of 1:100 are soft in one direction
)
NOT_ASKED = ("shown stable", "bending energy, N mm", "sum of reactions / pull")  # what it has no word for
NO_TIME_STEP = "time step"  # family that means nothing to Newton's method


@dataclasses.dataclass
class Peer:
    """The peer in the engine's place: it answers the first question, or all of them.

    found : what it said, answer by answer.
    """

    python: str
    folder: Path
    all_of_them: bool
    found: list[dict[str, Any]] = dataclasses.field(default_factory=list)

    def asks(self) -> bool:
        """Whether the next solve is the peer's."""
        return self.all_of_them or not self.found

    def answer(self, level: Level, state: State) -> None:
        """Put the peer's positions into the state. Raises PeerEnded if there are none."""
        question, answer = self.folder / "question.npz", self.folder / "answer.npz"
        answer.unlink(missing_ok=True)
        _pose(question, level, state)
        one = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        done = subprocess.run(
            [self.python, str(SCRIPT), str(question), str(answer)],
            env={**os.environ, **one, "PYTHONPATH": ""},
            capture_output=True,
            text=True,
            check=False,
        )
        if not answer.exists():
            raise PeerEnded(CRASHED, _last_words(done))
        with np.load(answer, allow_pickle=False) as stored:
            found, r = json.loads(str(stored["found"])), stored["r"]
        self.found.append(found)
        if found["status"] != "converged":
            raise PeerEnded(FAILED, found["message"])
        state.r[:] = level.scaled(r)
        state.step = found["iterations"]
        state.history.append((float(state.step), 0.0, 0.0, 0.0, 0.0))


class PeerEnded(Exception):
    """The peer gave no answer; outcome and message."""


def _last_words(done: subprocess.CompletedProcess[str]) -> str:
    """How a process ended that left no answer."""
    if done.returncode == -signal.SIGXCPU:
        return "no end within its CPU time"
    if done.returncode < 0:
        return f"ended by {signal.Signals(-done.returncode).name}"
    return (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]


def _pose(file: Path, level: Level, state: State) -> None:
    """Write what the peer needs to know: mesh and start in mm, material, supports, and what energy counts."""
    sheet, model = level.problem.sheet, level.model
    kind = "relaxed" if model.relaxed else "plate" if model.bending else "membrane"
    np.savez(
        file,
        u=level.grid.u,
        r=level.unscaled(state.r),
        fixed=level.fixed,
        closed=level.grid.closed,
        young=sheet.young_MPa,
        poisson=sheet.poisson,
        thickness=sheet.thickness_mm,
        model=kind,
    )


@contextmanager
def in_the_place_of_the_engine(peer: Peer) -> Iterator[None]:
    """Let the peer answer what the engine would be asked; what it does not answer, the engine does."""
    from cases import hard_engine
    from fdsolver import multilevel

    own = {name: getattr(multilevel, name) for name in ("relax_to_stable", "assemble", "level_nodes")}
    answered: list[bool] = []

    def solve(level: Level, state: State, *rest: Any) -> tuple[Status, dict[str, object]]:
        answered.append(peer.asks())
        if not answered[-1]:
            return own["relax_to_stable"](level, state, *rest)
        peer.answer(level, state)
        return Status.CONVERGED, {"stable": None, "how": "not examined", "lowest": None}

    def assembled(*parts: Any) -> Solution:
        solution = own["assemble"](*parts)
        if not answered[-1]:
            return solution
        energy = {**solution.energy_N_mm, "total": peer.found[-1]["energy"]}
        # what the verdict on the peer's shape would be is not the peer's word
        return dataclasses.replace(solution, energy_N_mm=energy, status=Status.CONVERGED)

    def one_mesh(nodes: int, levels: int | None) -> list[int]:
        return [nodes] if peer.asks() else own["level_nodes"](nodes, levels)

    with (
        mock.patch.multiple(multilevel, relax_to_stable=solve, assemble=assembled, level_nodes=one_mesh),
        mock.patch.multiple(hard_engine, relax_to_stable=solve, assemble=assembled),
    ):
        yield


def widened(requirement: Requirement) -> Requirement:
    """The requirement with the margin of another discretisation."""
    ends = [abs(end) for end in (requirement.low, requirement.high) if np.isfinite(end)]
    margin = MARGIN * max(ends) + SLACK_LEFT * (0.0 < max(ends) < 1.0)
    margin = NEAR if requirement.quantity == AFFINE else margin
    return dataclasses.replace(requirement, low=requirement.low - margin, high=requirement.high + margin)


def same_energy(solution: Solution, row: dict[str, Any] | None) -> tuple[Requirement, ...]:
    """Require the energy of the table's row, if that was found right."""
    if row is None or row["verdict"] != AS_EXPECTED or row["status"] != "converged":
        return ()
    wanted, plate = row["energy"], solution.method == "koiter"
    scale = solution.sheet.young_MPa * solution.sheet.thickness_mm * solution.grid.length_mm**2
    margin = max(SAME_ENERGY[plate] * abs(wanted), SLACK_LEFT * scale)
    return (
        Requirement("energy, N mm, as here", solution.energy_N_mm["total"], wanted - margin, wanted + margin),
    )


def tried(case: HardCase, row: dict[str, Any] | None, python: str) -> dict[str, Any]:
    """How the peer ended on a case: name, family, outcome, message, iterations, CPU seconds."""
    with tempfile.TemporaryDirectory(prefix="peer-") as folder:
        peer = Peer(python, Path(folder), all_of_them=case.family == "units")
        try:
            with in_the_place_of_the_engine(peer):
                finding = case.find()
            needed = [widened(item) for item in finding.requirements if item.quantity not in NOT_ASKED]
            needed += same_energy(finding.solution, row)
            broken = [item for item in needed if not item.holds]
            outcome = RIGHT if not broken and "converged" in case.expected else WRONG
            message = "; ".join(
                f"{item.quantity}: {item.value:.4g}, required {item.low:.4g} to {item.high:.4g}"
                for item in broken
            )
            if outcome == WRONG and not broken:
                message = f"it converged, where the end was to be {' or '.join(case.expected)}"
        except PeerEnded as ended:
            outcome, message = ended.args
    last = peer.found[-1] if peer.found else {}
    return {
        "name": case.name,
        "family": case.family,
        "outcome": outcome,
        "message": message or last.get("message", ""),
        "iterations": last.get("iterations"),
        "cpu_seconds": last.get("cpu_seconds"),
        "versions": last.get("versions", {}),
    }


def in_process(name: str, results: Path, python: str) -> dict[str, Any]:
    """`tried` in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-m", "tests.benchmarks.hard_peer", "--python", python, "--out", str(results)]
        + ["--case", name],
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout.splitlines()[-1])


def campaign(results: Path, python: str, only: str = "") -> list[dict[str, Any]]:
    """Try all cases that mean something to the peer, and leave the rows in hard_peer.json."""
    rows = []
    for case in hard_cases():
        if case.family == NO_TIME_STEP or only not in case.name:
            continue
        rows.append(in_process(case.name, results, python))
        print(f"{rows[-1]['outcome']:20s} {case.name}: {rows[-1]['message']}", flush=True)
        results.mkdir(parents=True, exist_ok=True)
        (results / FILE).write_text(json.dumps({"peer": "FElupe", "rows": rows}, indent=1), encoding="utf-8")
    return rows


def main() -> int:
    """Try one case, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--python", required=True, help="a Python that has FElupe")
    parser.add_argument("--out", type=Path, default=Path("runs/benchmark"))
    parser.add_argument("--only", default="", help="part of a case's name")
    parser.add_argument("--case", default="", help="one case; prints its row")
    chosen = parser.parse_args()
    if not chosen.case:
        campaign(chosen.out, chosen.python, chosen.only)
        return 0
    ours = {row["name"]: row for row in read_hard(chosen.out / "hard")}
    case = next(case for case in hard_cases() if case.name == chosen.case)
    print(json.dumps(tried(case, ours.get(case.name), chosen.python)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
