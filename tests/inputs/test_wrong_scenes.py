"""Every mistake of a scene earns its exact sentence; a file that is no scene is refused before it is parsed."""

from __future__ import annotations

import os
import time
import tomllib
from pathlib import Path

import pytest

from cases.__main__ import main
from cases.read import LARGEST_FILE
from cases.scene import SceneError, load_scene
from cases.schema import Edge, Line
from cases.validate import SINGLE, AnySheetKeys, Heading, allowed, fields_of

TABLE = tomllib.loads(Path(__file__).with_name("wrong_scenes.toml").read_text(encoding="utf-8"))["scene"]
WRONG_SCENES = [pytest.param(row["text"], row["sentences"], id=row["name"]) for row in TABLE]


def sentences(source, overrides=()):
    """The sentences that a scene is refused with."""
    with pytest.raises(SceneError) as refusal:
        load_scene(source, overrides)
    return [str(problem) for problem in refusal.value.problems]


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("text", "expected"), WRONG_SCENES)
def test_wrong_scene_earns_its_sentences(here, text, expected):
    (here / "wrong.toml").write_text(text)
    assert sentences("wrong.toml") == [f"wrong.toml: {sentence}" for sentence in expected]


@pytest.mark.parametrize(("text", "expected"), WRONG_SCENES[::5])
def test_wrong_scene_exits_2_and_writes_nothing(here, capsys, text, expected):
    (here / "wrong.toml").write_text(text)
    assert main(["run", "wrong.toml", "--method", "tension-field"]) == 2
    output = capsys.readouterr()
    assert output.err.splitlines() == [f"wrinkle: wrong.toml: {sentence}" for sentence in expected]
    assert output.out == ""
    assert [path.name for path in here.iterdir()] == ["wrong.toml"]


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"a = 1\na = 2\n", "is not valid TOML: Cannot overwrite a value (at line 2, column 6)"),
        (b"[mesh]\n[mesh]\n", "is not valid TOML: Cannot declare ('mesh',) twice (at line 2, column 6)"),
        (b"a = \n", "is not valid TOML: Invalid value (at line 1, column 5)"),
        (b"title = 'x'\nbad \xff\n", "is not a text file: line 2 is not UTF-8"),
        (b"\x7fELF\x00\x01", "is not a text file: it contains zero bytes"),
        (b"a = " + b"[" * 50_000, "is nested too deeply; at most 8 levels are allowed"),
        (b"a" + b".a" * 50_000 + b" = 1", "is nested too deeply; at most 8 levels are allowed"),
        (b"a = [[[[[[[[[[1]]]]]]]]]]", "is nested too deeply; at most 8 levels are allowed"),
        (b"#" * (LARGEST_FILE + 1), "is larger than 1000000 bytes; a scene file is a few lines of text"),
    ],
    ids=[
        "duplicate-key",
        "duplicate-table",
        "syntax",
        "not-utf8",
        "binary",
        "arrays",
        "dots",
        "shallow",
        "large",
    ],
)
def test_file_that_is_no_scene(here, content, expected):
    (here / "wrong.toml").write_bytes(content)
    started = time.perf_counter()
    assert sentences("wrong.toml") == [f"wrong.toml: {expected}"]
    # refused before the parser's quadratic work, which takes minutes for the deep keys
    assert time.perf_counter() - started < 5.0


def test_whole_number_of_thousands_of_digits(here):
    (here / "wrong.toml").write_text("mesh.nodes = " + "9" * 5000)
    (sentence,) = sentences("wrong.toml")
    assert sentence.startswith("wrong.toml: is not valid TOML: Exceeds the limit (4300 digits)")


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("anulus", 'anulus: there is no scene or file of this name; did you mean "annulus"?'),
        ("./hole.tml", './hole.tml: there is no such file; the nearest built-in scene is "hole"'),
        (
            "nowhere/annulus.toml",
            'nowhere/annulus.toml: there is no such file; the nearest built-in scene is "annulus"',
        ),
        ("folder", "folder: is a folder; give the scene file in it"),
        ("result", "result: is a folder; give the scene file in it (it contains scene.toml)"),
        ("/dev/null", "/dev/null: is not a regular file"),
        ("", '"": is a folder; give the scene file in it'),
        ("a\0b", '"a\\u0000b": cannot be read: embedded null byte'),
        ("x" * 5000, '"' + "x" * 56 + "...: cannot be read: File name too long"),
    ],
    ids=["typo", "no-file", "no-folder", "folder", "result-folder", "device", "empty", "zero-byte", "long"],
)
def test_source_that_is_no_scene_file(here, source, expected):
    (here / "folder").mkdir()
    (here / "result").mkdir()
    (here / "result" / "scene.toml").write_text("")
    assert sentences(source) == [expected]


def test_name_like_nothing_lists_the_scenes(here):
    (sentence,) = sentences("xyzzy")
    assert "built-in are" in sentence and '"strip-tension"' in sentence


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_unreadable_file(here):
    file = here / "secret.toml"
    file.write_text("")
    file.chmod(0)
    assert sentences("secret.toml") == ["secret.toml: cannot be read: Permission denied"]


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ("mesh.nodes", '--set: "mesh.nodes" must be KEY=VALUE, as in mesh.nodes=20000'),
        ("=3", '--set: "=3" must be KEY=VALUE, as in mesh.nodes=20000'),
        (
            "mesh.nodes=",
            '--set: mesh.nodes = "": must be a TOML value (80, [0, 0, 80], "text") or one bare word',
        ),
        (
            "edges.inner.move_mm=[0,0,80",
            '--set: edges.inner.move_mm = "[0,0,80": must be a TOML value (80, [0, 0, 80], "text") or one bare word',
        ),
        (
            "mesh.nodes=500\nmaterial.poisson=0.1",
            '--set: mesh.nodes = "500\\nmaterial.poisson=0.1": must be a TOML value (80, [0, 0, 80], "text")'
            " or one bare word",
        ),
        ("mesh..nodes=3", '--set: mesh."".nodes = 3: must be a dotted key of words, as in edges.top.move_mm'),
        ("sheet.shape.kind=3", "--set: sheet.shape.kind = 3: sheet.shape is a value, not a table"),
        ("mesh.nods=3", '--set: mesh.nods = 3: unknown key; did you mean "nodes"?'),
        (
            "mesh.nodes=many",
            '--set: mesh.nodes = "many": must be a whole number from 400 to 50000000',
        ),
        (
            "sheet.inner_radius_mm=300",
            "--set: sheet.inner_radius_mm = 300.0: must be below sheet.outer_radius_mm, which is 250",
        ),
    ],
)
def test_wrong_change(change, expected):
    assert sentences("annulus", [change]) == [expected]


def test_changes_and_scene_are_reported_together(here):
    (here / "wrong.toml").write_text(
        'sheet.shape = "annulus"\nedges.inner.support = "pinned"\nmesh.nodes = 1\n'
    )
    found = sentences("wrong.toml", ["material.poisson=2", "nonsense"])
    assert [sentence.partition(":")[0] for sentence in found] == ["--set", "--set", "wrong.toml"]


def test_every_key_says_what_is_allowed():
    for model in (Heading, AnySheetKeys, Edge, Line, *SINGLE.values()):
        for key, info in fields_of(model).items():
            assert key == "shape" or allowed(info), f"{model.__name__}.{key} has no sentence"
