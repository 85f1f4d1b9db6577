"""Study files: which points they make, and every mistake at once with its sentence."""

from __future__ import annotations

import pytest

from cases.problems import SceneError
from cases.scene import load_scene, scene_toml
from cases.study_file import load_study, study_names


@pytest.fixture
def write(tmp_path):
    def study(text, name="made.toml"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return study


def problems_of(path):
    with pytest.raises(SceneError) as refused:
        load_study(path)
    return [str(problem).removeprefix(f"{path}: ") for problem in refused.value.problems]


def test_every_combination_is_one_point(write):
    study = load_study(
        write(
            '[study]\nscene = "stretch"\nmethods = ["koiter", "membrane"]\nnodes = [500, 900]\nseeds = [3, 4]\n'
            "[vary]\nsheet.thickness_mm = [0.1, 0.2, 0.3]\n"
            '"edges.top.move_mm" = [[0, 10, 0], [0, 20, 0]]\n'
        )
    )
    assert study.keys == ("sheet.thickness_mm", "edges.top.move_mm")
    # the plate starts at random, from each seed; the membrane does not, so the first seed is enough
    assert len([p for p in study.points if p.method == "koiter"]) == 3 * 2 * 2 * 2
    assert {p.seed for p in study.points if p.method == "membrane"} == {3}
    assert len([p for p in study.points if p.method == "membrane"]) == 3 * 2 * 2
    assert len({p.name for p in study.points}) == len(study.points)
    assert study.points[0].changes == {"sheet.thickness_mm": 0.1, "edges.top.move_mm": [0, 10, 0]}


def test_point_tables_are_single_points(write):
    study = load_study(
        write(
            '[study]\nscene = "annulus"\nmethods = ["exact"]\n'
            "[[point]]\nedges.inner.rotate_deg = 10\n[[point]]\nedges.inner.rotate_deg = 20\nsheet.thickness_mm = 1\n"
        )
    )
    assert [dict(point.changes) for point in study.points] == [
        {"edges.inner.rotate_deg": 10},
        {"edges.inner.rotate_deg": 20, "sheet.thickness_mm": 1},
    ]


def test_nothing_varied_is_one_point_per_fitting_method(write):
    methods = [point.method for point in load_study(write('[study]\nscene = "stretch"\n')).points]
    assert "koiter" in methods and "exact" not in methods
    assert "exact" in [p.method for p in load_study(write('[study]\nscene = "annulus"\n')).points]


def test_a_scene_file_is_found_beside_the_study(write, monkeypatch, tmp_path):
    write(scene_toml(load_scene("stretch")), "mine.toml")
    monkeypatch.chdir(tmp_path.parent)
    study = load_study(write('[study]\nscene = "mine.toml"\nmethods = ["membrane"]\n'))
    assert study.scene == str(tmp_path / "mine.toml")


def test_another_scene_of_the_same_name_has_other_points(write):
    names = []
    for thickness in (0.1, 0.2):
        write(scene_toml(load_scene("stretch", {"sheet.thickness_mm": thickness})), "mine.toml")
        study = load_study(write('[study]\nscene = "mine.toml"\nmethods = ["membrane"]\n'))
        names += [point.name for point in study.points]
    assert names[0] != names[1], "its results must not be taken for the other's"


def test_points_that_cannot_be_solved_are_kept_with_the_reason(write):
    study = load_study(write('[study]\nscene = "hole"\nmethods = ["exact", "tension-field"]\n'))
    assert [bool(point.refused) for point in study.points] == [True, False]
    assert "closed form" in study.points[0].refused


def test_the_name_follows_the_solve_and_not_the_place_in_the_file(write):
    head = '[study]\nscene = "stretch"\nmethods = ["koiter"]\n[vary]\n'
    few = load_study(write(head + "sheet.thickness_mm = [0.2, 0.3]\n"))
    more = load_study(write(head + "sheet.thickness_mm = [0.3, 0.1, 0.2]\n"))
    assert {point.name for point in few.points} < {point.name for point in more.points}
    other = load_study(
        write(head.replace("[vary]", "nodes = [5000]\n[vary]") + "sheet.thickness_mm = [0.2]\n")
    )
    assert {point.name for point in other.points}.isdisjoint(point.name for point in more.points)


@pytest.mark.parametrize("name", study_names())
def test_built_in_studies_have_points_that_can_be_solved(name):
    study = load_study(name)
    assert len(study.points) >= 20
    assert all(point.refused == "" for point in study.points)


def test_all_mistakes_of_a_file_are_reported_at_once(write):
    found = problems_of(
        write(
            '[study]\nscene = "anulus"\nmethods = ["koitr", "exact"]\nnodes = [1]\nsceds = [1]\n'
            "[vary]\nsheet.thickness_mm = 3\n[varry]\na = 1\n"
        )
    )
    assert found == [
        'varry = a table: unknown key; allowed are study, vary, point; did you mean "vary"?',
        "vary.sheet.thickness_mm = 3: must be a list of values, one to 1000 of them",
        "study.nodes = [1]: must be a list of whole numbers from 400 to 50000000",
        'study.sceds = [1]: unknown key; did you mean "seeds"?',
        found[4],
        found[5],
    ]
    assert found[4].startswith('study.methods = "koitr": must be "auto", ')
    assert found[4].endswith('; did you mean "koiter"?')
    assert found[5] == 'anulus: there is no scene or file of this name; did you mean "annulus"?'


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "study.scene: must be a built-in scene or the path of a scene file"),
        ("study = 3\n", "study = 3: must be a table, as in [study]"),
        ('[study]\nscene = "stretch"\nmethods = []\n', "study.methods = []: must be a list of methods"),
        ('[study]\nscene = "stretch"\nseeds = [-1]\n', "study.seeds = [-1]: must be a list of whole numbers"),
        ('point = 3\n[study]\nscene = "stretch"\n', "point = 3: must be tables, as in [[point]]"),
        (
            '[study]\nscene = "stretch"\n[vary]\na.b = [1]\n[[point]]\na.b = 1\n',
            "vary: a study has [vary] or [[point]], not both",
        ),
        (
            '[study]\nscene = "stretch"\n[vary]\nsheet.thicknes_mm = [1]\n',
            'sheet.thicknes_mm = 1: unknown key; did you mean "thickness_mm"?',
        ),
        (
            '[study]\nscene = "stretch"\n[vary]\nmaterial.poisson = [0.3, 2]\n',
            "material.poisson = 2: must be a number above -1 and at most 0.5; the nearest is 0.5",
        ),
        (
            f'[study]\nscene = "stretch"\n[vary]\nmaterial.poisson = {list(range(200))}\n'
            f"material.young_MPa = {list(range(200))}\n",
            "vary: has 40000 combinations; at most 10000 are allowed",
        ),
        ("[study\n", "is not valid TOML"),
    ],
)
def test_a_mistake_earns_its_sentence(write, text, sentence):
    found = problems_of(write(text))
    assert any(sentence in problem for problem in found), found


def test_a_missing_study_names_the_nearest(tmp_path):
    assert problems_of("twist")[0] == 'there is no study or file of this name; did you mean "twist-and-lift"?'
    assert "built-in are" in problems_of(str(tmp_path / "qqq.toml"))[0]
    assert "no study or file" in problems_of("x" * 5000)[0]
