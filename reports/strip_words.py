"""How the strip's wrinkles grow and vanish with the pull, in words made from the numbers."""

from __future__ import annotations

import math

import numpy as np

from reports.content import Text
from reports.loads import wrinkled
from reports.plan_sheets import SHOWN_PULLS
from reports.strip_curves import PullCurves, crossings, lowest_flat
from reports.style import number, whole

ZHENG = (
    "Zheng's computed wrinkles, as the paper reports them, grow up to a pull of about 10 % and have nearly vanished "
    "at 30 %."
)


def trend(found: PullCurves) -> Text:
    """The trend of the results beside Zheng's, with the brackets of where wrinkles appear and vanish."""
    sentences = [ZHENG, *_largest(found), *_at_shown(found), *_window(found), *_last(found)]
    return Text(" ".join(sentences))


def _largest(found: PullCurves) -> list[str]:
    parts = []
    for name, what in (("amplitude", "crest height"), ("rms", "rms height")):
        sizes = np.array([v.value if np.isfinite(v.value) else v.finest for v in found.curves[name]])
        bands = np.nan_to_num([v.band for v in found.curves[name]])
        if np.isfinite(sizes).any():
            top = int(np.nanargmax(sizes))
            level = found.pulls[sizes + bands >= sizes[top] - bands[top]]
            where = f"{level[0]:g} to {level[-1]:g}" if len(level) > 1 else f"{level[0]:g}"
            parts.append(f"the {what} is greatest at {where} % ({found.curves[name][top].text()} mm)")
    if not parts:
        return ["No pull has a converged run, so nothing can be said here."]
    return [
        f"Here, across the middle, among the pulls that were run and as far as the bands tell, {' and '.join(parts)}."
    ]


def _at_shown(found: PullCurves) -> list[str]:
    parts = []
    for pull in SHOWN_PULLS:
        k = np.flatnonzero(np.isclose(found.pulls, pull))
        if k.size and np.isfinite(found.curves["amplitude"][k[0]].finest):
            last = found.finest(float(found.pulls[k[0]]))
            flat = last is not None and not wrinkled(last)
            size = "nothing" if flat else f"{found.curves['amplitude'][k[0]].text()} mm"
            parts.append(f"{size} at {pull:g} %")
    return [f"The crest height is {', '.join(parts)}."] if parts else []


def _window(found: PullCurves) -> list[str]:
    """Where wrinkles appear and vanish: by the wrinkled states, and by the eigenvalue of the flat one."""
    states = states_by_mesh(found)
    eigenvalues = found.flat_eigenvalues()
    sentences = []
    for appear, what in ((True, "appear"), (False, "vanish")):
        parts = []
        for nodes, rows in states.items():
            between = [
                f"between {low:g} and {high:g} %"
                for (low, before), (high, after) in zip(rows, rows[1:], strict=False)
                if before is not appear and after is appear
            ]
            passes = (
                [p for p, falls in crossings(*eigenvalues[nodes]) if falls is appear]
                if nodes in eigenvalues
                else []
            )
            by_flat = [f"flat state {'un' if appear else ''}stable from {p:.3g} % on" for p in passes]
            if between or by_flat:
                parts.append(
                    f"{' and '.join(between) or 'nowhere'} on {whole(nodes)} nodes ({', '.join(by_flat) or '–'})"
                )
        sentences += [f"Wrinkles {what} {'; '.join(parts)}."] if parts else []
    return sentences


def states_by_mesh(found: PullCurves) -> dict[float, list[tuple[float, bool]]]:
    """For each mesh the pulls (%) that converged on it, ascending, and whether the strip is wrinkled there."""
    states: dict[float, list[tuple[float, bool]]] = {}
    for pull, runs in found.runs.items():
        for run in runs:
            if run.converged:
                states.setdefault(run.value("nodes"), []).append((pull, wrinkled(run)))
    return dict(sorted(states.items()))


def _last(found: PullCurves) -> list[str]:
    """The evidence that flat is the truth where the strip stays flat at the largest pull."""
    last = found.finest(float(found.pulls[-1]))
    if last is None or not last.converged or wrinkled(last):
        return []
    lowest = lowest_flat(last, found.flat)
    known = lowest if math.isfinite(lowest) else last.value("stability", "lowest")
    return [
        f"At {found.pulls[-1]:g} % the flat state is the answer and not a failure to wrinkle: the lowest eigenvalue of "
        f"its out-of-plane tangent, relative, is {number(known, 2)} (positive: stable)."
    ]
