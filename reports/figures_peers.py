"""Error against CPU time of wrinklebench and of other programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

LOOKS = {
    "wrinklebench": ("#0072B2", "o"),
    "wrinklebench, limit": ("#56B4E9", "*"),
    "wrinklebench, quarter": ("#4477AA", "p"),
    "wrinklebench, quarter, limit": ("#99DDFF", "P"),
    "ngsolve": ("#D55E00", "s"),
    "dolfinx": ("#009E73", "D"),
    "felupe": ("#CC79A7", "^"),
    "calculix": ("#E69F00", "v"),
}
SMALLEST = 1e-9
FAILED_AT = 1.03  # of the height of the axes


def side_by_side(figure: FigureBase, runs: Sequence[Mapping[str, Any]], problems: Sequence[str]) -> None:
    """One panel per problem; a cross above the frame is a run without an answer, at the time it used."""
    curves = {}
    for k, problem in enumerate(problems):
        ax = figure.add_subplot(1, len(problems), k + 1)
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_title(problem)
        ax.set_xlabel("CPU time (s)")
        if k == 0:
            ax.set_ylabel("largest relative error (–)")
        for peer, (shade, marker) in LOOKS.items():
            mine = [run for run in runs if (run["peer"], run["problem"]) == (peer, problem)]
            good = [run for run in mine if "error" in run]
            if good:
                (curves[peer],) = ax.plot(
                    [run["cpu_seconds"] for run in good],
                    [max(run["error"], SMALLEST) for run in good],
                    color=shade,
                    marker=marker,
                    label=peer,
                    linewidth=1.8 if peer.startswith("wrinklebench") else 1.0,
                )
            for run in mine:
                if run["status"] != "converged":
                    ax.plot(
                        run["process_cpu_seconds"],
                        FAILED_AT,
                        "x",
                        color=shade,
                        transform=ax.get_xaxis_transform(),
                        clip_on=False,
                    )
    figure.legend(list(curves.values()), list(curves), loc="outside lower center", ncols=6, columnspacing=1.0)
