"""How the strip's wrinkles grow and vanish with the pull, in words made from the numbers."""

from __future__ import annotations

import numpy as np

from reports.content import Text
from reports.loads import wrinkled
from reports.plan_sheets import SHOWN_PULLS
from reports.strip_curves import PullCurves
from reports.style import number, whole

ZHENG = (
    "Zheng's computed wrinkles, as the paper reports them, grow up to a pull of about 10 % and have nearly vanished "
    "at 30 %."
)


def trend(found: PullCurves) -> Text:
    """The trend of the results beside Zheng's, with the brackets of where wrinkles appear and vanish."""
    sentences = [ZHENG, *_largest(found), *_at_shown(found), *_brackets(found), *_flat(found)]
    return Text(" ".join(sentences))


def _largest(found: PullCurves) -> list[str]:
    parts = []
    for name, what in (("amplitude", "largest height"), ("rms", "rms height")):
        sizes = np.array([v.finest for v in found.curves[name]])
        if np.isfinite(sizes).any():
            top = int(np.nanargmax(sizes))
            parts.append(
                f"the {what} is greatest at {found.pulls[top]:g} % ({found.curves[name][top].text()} mm)"
            )
    if not parts:
        return ["No pull has a converged run, so nothing can be said here."]
    return [f"Here, across the middle and among the pulls that were run, {' and '.join(parts)}."]


def _at_shown(found: PullCurves) -> list[str]:
    parts = []
    for pull in SHOWN_PULLS:
        k = np.flatnonzero(np.isclose(found.pulls, pull))
        if k.size and np.isfinite(found.curves["amplitude"][k[0]].finest):
            last = found.finest(float(found.pulls[k[0]]))
            flat = last is not None and not wrinkled(last)
            size = "nothing" if flat else f"{found.curves['amplitude'][k[0]].text()} mm"
            parts.append(f"{size} at {pull:g} %")
    return [f"The largest height is {', '.join(parts)}."] if parts else []


def _brackets(found: PullCurves) -> list[str]:
    """Between which pulls wrinkles appear and vanish, mesh by mesh."""
    sentences = []
    for appear, what in ((True, "appear"), (False, "vanish")):
        parts = [
            f"between {low:g} and {high:g} % on {whole(nodes)} nodes"
            for nodes, states in states_by_mesh(found).items()
            for (low, before), (high, after) in zip(states, states[1:], strict=False)
            if before is not appear and after is appear
        ]
        sentences += [f"Wrinkles {what} {', '.join(parts)}."] if parts else []
    return sentences


def states_by_mesh(found: PullCurves) -> dict[float, list[tuple[float, bool]]]:
    """For each mesh the pulls (%) that converged on it, ascending, and whether the strip is wrinkled there."""
    states: dict[float, list[tuple[float, bool]]] = {}
    for pull, runs in found.runs.items():
        for run in runs:
            if run.converged:
                states.setdefault(run.value("nodes"), []).append((pull, wrinkled(run)))
    return dict(sorted(states.items()))


def _flat(found: PullCurves) -> list[str]:
    """The evidence that flat is the truth where the strip stays flat at large pulls."""
    last = found.finest(float(found.pulls[-1]))
    if last is None or not last.converged or wrinkled(last):
        return []
    return [
        f"At {found.pulls[-1]:g} % the flat state is the answer and not a failure to wrinkle: the lowest eigenvalue of "
        f"its out-of-plane tangent, relative, is {number(last.value('stability', 'lowest'), 2)} (positive: stable)."
    ]
