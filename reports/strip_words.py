"""How the strip's wrinkles grow and vanish with the pull, in words made from the numbers."""

from __future__ import annotations

import numpy as np

from reports.content import Text
from reports.loads import wrinkled
from reports.strip_curves import PullCurves
from reports.style import number, whole

SHOWN = (5.0, 10.0, 20.0, 30.0)
ZHENG = (
    "Zheng's computed wrinkles, as the paper reports them, grow up to a pull of about 10 % and have nearly vanished "
    "at 30 %."
)


def trend(found: PullCurves) -> Text:
    """The trend of the results beside Zheng's, with the brackets of where wrinkles appear and vanish."""
    sentences = [ZHENG, *_largest(found), *_at_shown(found), *_brackets(found), *_flat(found)]
    return Text(" ".join(sentences))


def _largest(found: PullCurves) -> list[str]:
    sizes = np.array([v.finest for v in found.curves["rms"]])
    if not np.isfinite(sizes).any():
        return ["No pull has a converged run, so nothing can be said here."]
    top = int(np.nanargmax(sizes))
    value = found.curves["rms"][top]
    return [
        f"Here the rms height across the middle is largest at {found.pulls[top]:g} %, with {value.text()} mm, among "
        f"the pulls that were run."
    ]


def _at_shown(found: PullCurves) -> list[str]:
    parts = []
    for pull in SHOWN:
        k = np.flatnonzero(np.isclose(found.pulls, pull))
        if k.size and np.isfinite(found.curves["rms"][k[0]].finest):
            last = found.finest(float(found.pulls[k[0]]))
            flat = last is not None and not wrinkled(last)
            parts.append(f"{'flat' if flat else found.curves['rms'][k[0]].text() + ' mm'} at {pull:g} %")
    return [f"It is {', '.join(parts)}."] if parts else []


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
