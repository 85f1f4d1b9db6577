"""The two example studies, run to their ends, where the report looks for them."""

from __future__ import annotations

import json

import numpy as np

from cases.study import run_study
from cases.study_file import load_study

PUBLISHED_END = ("converged", "refused", "zone_inverted")
SECTION = "sections.midsection."


def ran(verify, name):
    table = run_study(load_study(name), verify.root.parent / f"{name}-study", say=print)
    verify.note("points", len(table))
    verify.equal(
        "points without a named end",
        int((~table["status"].isin(PUBLISHED_END)).sum()),
        0,
        "every point has an answer, or is refused for a reason: no axisymmetric state, a sheet folded over",
    )
    return table


def test_thickness_against_pull(verify):
    """Wavelength and amplitude of the stretched sheet against thickness and pull, by every method"""
    table = ran(verify, "thickness-and-pull")
    table = table.assign(pull=table["edges.top.move_mm"].map(lambda text: json.loads(text)[1]))
    waves = table[(table["method"] == "koiter") & table[SECTION + "wavelength_mm"].notna()]
    powers = [
        np.polyfit(np.log(group["sheet.thickness_mm"]), np.log(group[SECTION + "wavelength_mm"]), 1)[0]
        for _, group in waves.groupby("pull")
        if len(group) > 1
    ]
    verify.within(
        "power of the thickness in the wavelength",
        float(np.mean(powers)),
        0.4,
        0.6,
        "one half (Cerda and Mahadevan 2003); a sheet of few waves is held by its edges too",
    )
    same = waves.merge(
        table[table["method"] == "koiter-published"],
        on=["sheet.thickness_mm", "pull"],
        suffixes=("", " there"),
    )
    apart = same[SECTION + "amplitude_mm"] / same[SECTION + "amplitude_mm there"] - 1.0
    verify.below(
        "amplitudes of the two schemes apart",
        float(apart.abs().max()),
        0.05,
        "one continuum, two discretisations of second order at 7 nodes per wave and more",
    )


def test_twist_against_lift(verify):
    """The wrinkled band of the annulus against twist and lift, beside the closed form"""
    table = ran(verify, "twist-and-lift")
    ends = ["paths.radius.wrinkled_from_mm", "paths.radius.wrinkled_to_mm"]
    place = ["edges.inner.rotate_deg", "edges.inner.move_mm"]
    known = table[(table["method"] == "exact") & table[ends[0]].notna()]
    tried = table[table["method"] == "tension-field"]
    found = tried[tried["status"] == "converged"]
    solved = table[(table["method"] == "exact") & (table["status"] == "converged")]
    answers = solved.merge(tried, on=place, suffixes=("", " found"))
    verify.equal(
        "loads with a closed form and no answer",
        int((answers["status found"] != "converged").sum()),
        0,
        "the relaxed energy is convex: the closed form is the one answer, folded over itself or not",
    )
    for name in ("energy_N_mm.total", "reactions.inner.moment_N_mm.z"):
        turned = answers[answers[place[0]] > 0.0]
        verify.below(
            f"largest relative error of {name}",
            float((turned[f"{name} found"] / turned[name] - 1.0).abs().max()),
            1.8e-3,
            "a zone on 5 000 nodes is 2 pi / 148 of its radius wide, and the scheme of second order",
        )
    both = known.merge(found, on=place, suffixes=("", " found"))
    verify.above("loads with a band in both", len(both), 10, "else nothing is compared")
    for end in ends:
        verify.below(
            f"largest distance of {end}",
            float((both[end] - both[f"{end} found"]).abs().max()),
            8.2,
            "one ring of zones on 5 000 nodes: 2.7 mm wide at the hub, 8.2 mm further out",
            "mm",
        )
