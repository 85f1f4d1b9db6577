"""What the README promises: its Python runs, its tables name what exists, its make targets are there."""

from __future__ import annotations

import json
import re
import tomllib

import pytest


@pytest.fixture(scope="module")
def readme(project):
    return (project / "README.md").read_text(encoding="utf-8")


def table_rows(text, first_head):
    """Cells of the rows of the Markdown table whose head begins so."""
    lines = text[text.index(first_head) :].splitlines()
    body = lines[2 : next(k for k, line in enumerate(lines) if not line.startswith("|"))]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in body]


def test_python_example_runs(readme, tmp_path, monkeypatch, capsys):
    (example,) = re.findall(r"```python\n(.*?)```", readme, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(example, "README.md", "exec"), names)
    assert capsys.readouterr().out.startswith("converged ")
    assert (names["again"].r == names["solution"].r).all()
    stored = json.loads((tmp_path / "runs" / "annulus" / "result.json").read_text(encoding="utf-8"))
    assert stored["status"] == "converged"


def test_every_scene_is_in_the_table_with_the_methods_that_it_has(readme, project):
    from cases import load_scene
    from cases.exact import has_exact

    rows = {row[0].strip("`"): row for row in table_rows(readme, "| scene | sheet and load |")}
    assert set(rows) == {path.stem for path in (project / "cases" / "data").glob("*.toml")}
    for scene, row in rows.items():
        assert (row[2] == "yes") == has_exact(load_scene(scene)), (
            f"{scene}: exact is {row[2]!r} in the README"
        )


def test_every_dependency_has_its_reason(readme, project):
    metadata = tomllib.loads((project / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = metadata["dependencies"] + [d for e in metadata["optional-dependencies"].values() for d in e]
    given = " ".join(row[0] for row in table_rows(readme, "| package | why |") if row[1])
    named = set(re.findall(r"[a-z][a-z0-9-]*", given))
    assert {re.match(r"[\w-]+", item).group() for item in wanted} <= named


def test_make_targets_and_files_exist(readme, project):
    targets = set(re.findall(r"^(\w+):", (project / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    assert set(re.findall(r"^    make (\w+)", readme, re.MULTILINE)) <= targets
    links = re.findall(r"\]\(([^)]+)\)", readme)
    assert links and all((project / link).is_file() for link in links)


def test_exit_codes_of_the_table_are_those_of_the_statuses(readme):
    from cases.__main__ import MACHINE_FAILED
    from cases.arguments import BAD_INPUT
    from fdsolver.result import Status

    codes = {int(row[0]) for row in table_rows(readme, "| code | meaning |")}
    assert codes == {status.exit_code for status in Status} | {MACHINE_FAILED, BAD_INPUT}
