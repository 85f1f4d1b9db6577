"""Random scene files, overrides and command lines: a scene or a list of sentences, never anything else."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from cases.__main__ import main
from cases.scene import Scene, SceneError, load_scene, scene_hash, scene_toml
from cases.schema import Edge, Effects, Line, Material, Mesh, Solver, Start, Symmetry
from cases.validate import TOP_LEVEL, AnySheetKeys, choices_of, fields_of

# The time of one example says nothing here; the first one compiles the schema.
PATIENT = settings(
    deadline=None, max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture]
)

MODELS = {
    "sheet": AnySheetKeys,
    "material": Material,
    "start": Start,
    "effects": Effects,
    "symmetry": Symmetry,
    "mesh": Mesh,
    "solver": Solver,
    "edges.inner": Edge,
    "edges.outer": Edge,
    "edges.left": Edge,
    "edges.top": Edge,
    "sections.a": Line,
    "paths.b": Line,
}
KEYS = [f"{table}.{key}" for table, model in MODELS.items() for key in fields_of(model)] + list(TOP_LEVEL)
WORDS = sorted(
    {word for model in MODELS.values() for info in fields_of(model).values() for word in choices_of(info)}
)

numbers = st.one_of(
    st.floats(width=64),
    st.integers(-(10**400), 10**400),
    st.integers(-3, 3),
    st.floats(0.0, 300.0),
    st.sampled_from([0, -0.0, 1e-320, 1e308, math.nan, math.inf, 2**63, 400, 0.31]),
)
texts = st.one_of(
    st.text(max_size=20), st.sampled_from([*WORDS, "annulus", "rectangle", "rectangle-with-hole", "mode:1"])
)
scalars = st.one_of(numbers, texts, st.booleans(), st.datetimes(), st.dates(), st.times())
values = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(texts, inner, max_size=3),
    max_leaves=8,
)
plausible_keys = st.sampled_from(KEYS)
any_keys = st.one_of(
    plausible_keys,
    st.text(max_size=12),
    st.lists(st.sampled_from([*TOP_LEVEL, "inner", "shape", "", " "]) | st.text(max_size=5), max_size=10).map(
        ".".join
    ),
)
base_scenes = st.sampled_from(["annulus", "hole", "stretch", "shear-rails"])


def outcome(source: str | Path, overrides: object) -> Scene | None:
    """The scene, or None if it was refused as it should be; anything else fails the test."""
    try:
        return load_scene(source, overrides)  # type: ignore[arg-type]
    except SceneError as error:
        assert error.problems
        for problem in error.problems:
            sentence = str(problem)
            assert sentence.isprintable() and problem.message
            assert len(sentence) < 800
        return None


def check_scene(scene: Scene, folder: Path) -> None:
    """A scene that was accepted survives being written and read, and stands for one hash."""
    file = folder / "again.toml"
    file.write_text(scene_toml(scene), encoding="utf-8")
    again = load_scene(file)
    assert scene_toml(again) == scene_toml(scene)
    assert scene_hash(again, "koiter") == scene_hash(scene, "koiter")
    size = scene.sheet.size_mm
    assert math.isfinite(size) and scene.sheet.smallest_width_mm > 0.0
    assert any(edge.support != "free" for edge in scene.edges.values())


@PATIENT
@given(base_scenes, st.dictionaries(any_keys, values, max_size=4))
@example("annulus", {"edges.inner": 3, "edges.inner.support": "pinned"})
@example("annulus", {"sheet": []})
@example("annulus", {"title": "\x1b[2J"})
@example("annulus", {"mesh.nodes": 10**5000})
@example("annulus", {"sheet.shape": ["annulus"]})
@example("annulus", {"start.from": "mode:" + "9" * 5000})
@example("annulus", {"material": {"young_MPa": {"a": {"b": {"c": {"d": {"e": {"f": {"g": 1}}}}}}}}})
def test_any_mapping_of_overrides_gives_a_scene_or_sentences(tmp_path, base, overrides):
    scene = outcome(base, overrides)
    if scene is not None:
        check_scene(scene, tmp_path)


@PATIENT
@given(
    base_scenes, plausible_keys, numbers | st.sampled_from(WORDS) | st.lists(numbers, min_size=2, max_size=3)
)
def test_any_value_of_a_known_key_gives_a_scene_or_sentences(tmp_path, base, key, value):
    scene = outcome(base, {key: value})
    if scene is not None:
        check_scene(scene, tmp_path)


@PATIENT
@given(
    base_scenes,
    st.lists(st.text(max_size=40) | st.tuples(any_keys, st.text(max_size=20)).map("=".join), max_size=3),
)
@example("annulus", ["mesh.nodes=500\nmaterial.poisson=0.1"])
@example("annulus", ["mesh.nodes=" + "[" * 50_000])
@example("annulus", ["mesh.nodes=" + "9" * 5000])
@example("annulus", ["a." * 50_000 + "b=1"])
def test_any_set_option_gives_a_scene_or_sentences(base, changes):
    outcome(base, changes)


@PATIENT
@given(st.binary(max_size=200) | st.text(max_size=200).map(str.encode))
@example(b"\xff\xfe\x00")
@example(b"a = " + b"[" * 100_000)
@example(b"a" + b".a" * 100_000 + b" = 1")
@example(b"n = " + b"9" * 5000)
@example(b"a = 0x" + b"f" * 5000)
@example(b'"" = 1\n[""]')
def test_any_file_gives_a_scene_or_sentences(tmp_path, content):
    file = tmp_path / "random.toml"
    file.write_bytes(content)
    outcome(file, ())


@PATIENT
@given(st.dictionaries(st.sampled_from(TOP_LEVEL) | st.text(max_size=8), values, max_size=6))
def test_any_document_gives_a_scene_or_sentences(tmp_path, document):
    lines = [f"{json.dumps(key)} = {toml(value)}" for key, value in document.items()]
    file = tmp_path / "random.toml"
    file.write_text("\n".join(lines), encoding="utf-8", errors="surrogatepass")
    outcome(file, ())


def toml(value: object) -> str:
    """A value as TOML writes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {toml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(toml(item) for item in value) + "]"
    if isinstance(value, int):
        return hex(value) if value > 0 else "-1"
    return json.dumps(value) if isinstance(value, str) else str(value)


options = st.sampled_from(
    [
        "--nodes",
        "--seed",
        "--threads",
        "--tol",
        "--methods",
        "--set",
        "--out",
        "--strict",
        "--accuracy",
        "--scenes",
        "-x",
    ]
)
commands = st.sampled_from(
    ["run", "compare", "report", "list", "doctor", "plan", "cost", "hard", "study", "rum", ""]
)


@PATIENT
@given(commands, st.lists(options | st.text(max_size=12), max_size=6))
def test_any_command_line_with_a_mistake_exits_2_and_writes_nothing(
    tmp_path, monkeypatch, capsys, command, words
):
    monkeypatch.chdir(tmp_path)
    # whatever else is there, this option does not exist
    code = main([command, *words, "--no-such-option"])
    output = capsys.readouterr()
    assert code == 2
    assert all(line.startswith("wrinkle: ") and line.isprintable() for line in output.err.split("\n")[:-1])
    assert output.err
    assert output.out == ""
    assert list(tmp_path.iterdir()) == []


@PATIENT
@given(st.dictionaries(any_keys, values, min_size=1, max_size=3), st.text(max_size=8))
def test_any_wrong_scene_exits_2_and_writes_nothing(tmp_path, monkeypatch, capsys, overrides, nodes):
    monkeypatch.chdir(tmp_path)
    # one word each: a key may begin with a dash
    changes = [f"--set={key}={toml(value)}" for key, value in overrides.items()]
    # this key does not exist, so that nothing is ever solved here
    code = main(
        ["run", "annulus", "--method", "koiter", *changes, "--set", "sheet.no_such_key=1", f"--nodes={nodes}"]
    )
    output = capsys.readouterr()
    assert code == 2
    assert all(line.startswith("wrinkle: ") for line in output.err.splitlines())
    # too deep a nesting is reported alone
    assert "sheet.no_such_key" in output.err or "nested deeper than" in output.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("value", [None, object(), b"bytes", {1, 2}, 1j, lambda: 0])
def test_python_values_that_no_file_can_hold_are_refused(value):
    with pytest.raises(SceneError, match="material.poisson"):
        load_scene("annulus", {"material.poisson": value})
