"""Solve three problems by wrinklebench and by other programs, one after the other, each in a process of its own.

    python tests/benchmarks/peers/compare.py --python ngsolve=VENV/bin/python --python felupe=VENV/bin/python \\
        --python dolfinx=/usr/bin/python3 --python calculix=/usr/bin/python3

The environments are the user's: `pip install felupe ngsolve`; Debian has DOLFINx as python3-dolfinx-real and CalculiX
as calculix-ccx. A peer without an interpreter, or whose package is missing there, is noted as left out. The answers go
to peers.json beside the verification runs, where the report finds them. Not part of any test.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from cases import load_scene, run
from cases.machine import machine
from cases.mesh_sequence import mesh_limit

HERE = Path(__file__).resolve().parent
OWN, QUARTER, LIMIT = "wrinklebench", "wrinklebench, quarter", "{}, limit"
SHARED = "problem"  # meshes and starts, which no peer is charged with
PROBLEMS = {
    "annulus": ("energy_N_mm", "torque_N_mm"),
    "hole": ("energy_N_mm", "force_N"),
    "stretch": ("rms_mm",),
}
RELAXED, PLATE = ("annulus", "hole"), ("stretch",)
# (peer, script, problem) -> meshes: elements across for the peers, nodes for wrinklebench
PLAN = {
    (OWN, "own", "annulus"): (1200, 2500, 5000, 10_000, 20_000, 40_000, 80_000),
    (OWN, "own", "hole"): (1000, 2000, 4000, 8000, 12_000, 20_000),
    (OWN, "own", "stretch"): (7500, 15_000, 30_000, 60_000, 120_000),
    (QUARTER, "own_quarter", "stretch"): (7500, 10_000, 15_000, 30_000, 60_000, 120_000),
    ("ngsolve", "ngsolve_relaxed", "annulus"): (1, 2, 3, 4, 6),
    ("ngsolve", "ngsolve_relaxed", "hole"): (1, 2, 4, 6),
    ("ngsolve", "ngsolve_plate", "stretch"): (10, 16, 24, 32),
    ("dolfinx", "dolfinx_relaxed", "annulus"): (3, 4, 6, 8, 12, 16, 24),
    ("dolfinx", "dolfinx_relaxed", "hole"): (4, 6, 8, 12, 16),
    ("dolfinx", "dolfinx_plate", "stretch"): (16, 24, 32, 48, 64),
    ("felupe", "felupe_relaxed", "annulus"): (3, 4, 6, 8, 12, 16),
    ("felupe", "felupe_relaxed", "hole"): (4, 6, 8, 12),
    ("felupe", "felupe_plate", "stretch"): (12, 16, 24),
    ("calculix", "calculix_plate", "stretch"): (12, 16, 24, 32),
}
OMITTED = {
    "calculix, annulus and hole": "its law without compression (TENSION_ONLY) has no Poisson's ratio and is for"
    " solids; another law needs a Fortran routine compiled into the program",
}


def lines_of(script: str) -> int:
    """Statements of a script and of the modules beside it that it uses, or the lines of our scene file and command."""
    if script.startswith("own"):
        return 1 + _scene_lines() + (script == "own_quarter")
    tree = ast.parse((HERE / f"{script}.py").read_text(encoding="utf-8"))
    statements = [node for node in ast.walk(tree) if isinstance(node, ast.stmt)]
    texts = [
        node for node in statements if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    ]
    used = {node.module for node in statements if isinstance(node, ast.ImportFrom)} - {SHARED}
    beside = [name for name in used if name and (HERE / f"{name}.py").exists()]
    return len(statements) - len(texts) + sum(map(lines_of, beside))


def _scene_lines() -> int:
    """Lines of the longest of the three scene files: the command is one more."""
    folder = Path(sys.modules["cases"].__file__ or "").parent / "data"
    counts = []
    for problem in PROBLEMS:
        text = (folder / f"{problem}.toml").read_text(encoding="utf-8")
        counts.append(sum(bool(line.strip()) and not line.startswith("#") for line in text.splitlines()))
    return max(counts)


def solved(python: str, script: str, problem: str, mesh: int, seconds: int) -> dict[str, Any]:
    """The answer of one run, with CPU seconds and peak memory of the whole process and of those it called."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    top = str(HERE.parents[2])
    environment["PYTHONPATH"] = top if script.startswith("own") else ""
    command = [python, str(HERE / f"{script}.py"), problem, str(mesh)]
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    with tempfile.TemporaryFile("w+") as out:
        process = subprocess.Popen(
            command,
            stdout=out,
            stderr=subprocess.DEVNULL,
            env=environment,
            cwd=top,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 10)),
        )
        process.wait()
        out.seek(0)
        said = [line for line in out.read().splitlines() if line.startswith("{")]
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if said:
        found = json.loads(said[-1])
    elif process.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        found = {"status": "failed", "message": f"no answer within {seconds} s of CPU time"}
    else:
        found = {"status": "failed", "message": f"ended with code {process.returncode} and no answer"}
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {**found, "process_cpu_seconds": used, "seconds": time.perf_counter() - started}


def with_memory(python: str, script: str, problem: str, mesh: int, seconds: int) -> dict[str, Any]:
    """`solved` in a process of its own, whose children are that run's alone: their peak memory is the run's."""
    words = [sys.executable, __file__, "--one", python, script, problem, str(mesh), str(seconds)]
    return json.loads(subprocess.run(words, capture_output=True, text=True, check=True).stdout)


@cache
def closed_form() -> dict[str, float]:
    """Energy and torque of the annulus."""
    exact = run(load_scene("annulus"), "exact", nodes=2000)
    torque = float(exact.reactions["inner"].moment_N_mm[2])
    return {"energy_N_mm": exact.energy_N_mm["total"], "torque_N_mm": torque}


def references(runs: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """What errors are measured against: the closed form, and limits of our own meshes."""
    for name, value in closed_form().items():
        yield {"problem": "annulus", "quantity": name, "value": value, "band": 0.0, "how": "closed form"}
    for problem, names in PROBLEMS.items():
        mine = [
            r for r in runs if r["peer"] == OWN and r["problem"] == problem and r["status"] == "converged"
        ]
        for name in names if problem != "annulus" and len(mine) >= 3 else ():
            limit = mesh_limit([r["unknowns"] for r in mine], [r["values"][name] for r in mine])
            how = "the finest mesh of wrinklebench" if limit.refused else "limit of wrinklebench's meshes"
            yield {"problem": problem, "quantity": name, "value": limit.value, "band": limit.band, "how": how}


def with_errors(runs: list[dict[str, Any]], found: list[dict[str, Any]]) -> None:
    """Give every converged run its largest relative error."""
    known = {(r["problem"], r["quantity"]): r["value"] for r in found}
    for one in runs:
        if one["status"] == "converged":
            names = [name for name in PROBLEMS[one["problem"]] if (one["problem"], name) in known]
            truths = [known[one["problem"], name] for name in names]
            one["error"] = max(
                abs(one["values"][name] / truth - 1.0) for name, truth in zip(names, truths, strict=True)
            )


def compare(pythons: dict[str, str], seconds: int, out: Path, problems: list[str]) -> None:
    """Run the plan, writing `out` on the way."""
    runs, omitted = [], dict(OMITTED)
    for (peer, script, problem), meshes in PLAN.items():
        if problem not in problems:
            continue
        if peer not in pythons:
            omitted[peer] = "not installed here"
            continue
        for mesh in meshes:
            found = with_memory(pythons[peer], script, problem, mesh, seconds)
            row = {"peer": peer, "problem": problem, "mesh": mesh, "lines": lines_of(script), **found}
            print(f"{peer} {problem} {mesh}: {row['status']} {row.get('message', '')}", flush=True)
            if "No module named" in row.get("message", ""):
                omitted[peer] = row["message"]
                break
            runs += rows_of(row)
        write(runs, omitted, out)  # what was found so far: a comparison takes long


def rows_of(row: dict[str, Any]) -> list[dict[str, Any]]:
    """The row of a run, and one of its limits where it has one of every quantity, at no further cost."""
    limits = row.pop("limits", {})
    if None in limits.values() or not limits:
        return [row]
    return [row, {**row, "peer": LIMIT.format(row["peer"]), "values": limits}]


def write(runs: list[dict[str, Any]], omitted: dict[str, str], out: Path) -> None:
    """Write what was found, with the errors."""
    truths = list(references(runs))
    with_errors(runs, truths)
    document = {"runs": runs, "references": truths, "omitted": omitted, "machine": machine()}
    out.parent.mkdir(parents=True, exist_ok=True)
    unfinished = out.with_suffix(".part")
    unfinished.write_text(json.dumps(document, indent=1), encoding="utf-8")
    unfinished.replace(out)


def main() -> None:
    """Read the command line."""
    if sys.argv[1:2] == ["--one"]:
        python, script, problem, mesh, seconds = sys.argv[2:]
        found = solved(python, script, problem, int(mesh), int(seconds))
        found["memory_MB"] = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024.0
        print(json.dumps(found))
        return
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--python", action="append", default=[], metavar="PEER=INTERPRETER")
    parser.add_argument("--problems", default=",".join(PROBLEMS), metavar="A,B,..")
    parser.add_argument("--seconds", type=int, default=120, help="CPU limit of each run (default: 120)")
    parser.add_argument("--out", type=Path, default=Path("runs/benchmark/peers.json"))
    words = parser.parse_args()
    pythons = {
        OWN: sys.executable,
        QUARTER: sys.executable,
        **dict(word.split("=", 1) for word in words.python),
    }
    compare(pythons, words.seconds, words.out, words.problems.split(","))


if __name__ == "__main__":
    main()
