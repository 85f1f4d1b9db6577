"""The house rules, read from the source: who imports whom, file lengths, and nothing of one machine."""

from __future__ import annotations

import ast
import re
import subprocess
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
from packaging.requirements import Requirement

PROJECT = Path(__file__).resolve().parents[1]

# fdsolver <- tensionfield <- cases <- reports; femref <- cases
MAY_IMPORT = {
    "fdsolver": set(),
    "femref": set(),
    "tensionfield": {"fdsolver"},
    "cases": {"fdsolver", "tensionfield", "femref"},
    "reports": {"fdsolver", "tensionfield", "femref", "cases"},
}
# the command line is where `wrinkle report` meets its page; it imports lazily
COMMAND_LINE = {"cases/__main__.py": {"reports"}}
# solvers take arrays and give arrays: no drawing, no scene files, no result tables, no page, no progress bar
NOT_IN_SOLVERS = {
    "matplotlib",
    "meshio",
    "pandas",
    "pydantic",
    "jinja2",
    "rich",
    "tomllib",
    "argparse",
    "logging",
}
# reports read result folders; none of these is needed to read one, all of them run a solver
RUNS_A_SOLVER = {"fdsolver.relax", "fdsolver.multilevel", "tensionfield.solve", "cases.runner"}
LONGEST_FILE = 300
# a shape or an edge of the grid may share its name with a scene
SHAPE_AND_EDGE_NAMES = {"annulus", "hole", "rectangle", "rectangle-with-hole"}


def source_files(package: str) -> list[Path]:
    return sorted((PROJECT / package).rglob("*.py"))


def imports_of(tree: ast.AST, package: str) -> Iterator[str]:
    """Dotted names that a module imports, `from a import b` giving "a" and "a.b"; lazy imports included."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                base = f"{package}.{base}".rstrip(".")
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)


def imports(path: Path) -> set[str]:
    return set(imports_of(ast.parse(path.read_text(encoding="utf-8")), path.relative_to(PROJECT).parts[0]))


def tracked_files() -> list[Path]:
    """Files under version control; all files of the source tree where there is no checkout."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=PROJECT, capture_output=True, text=True)
    if listed.returncode == 0 and listed.stdout:
        return [PROJECT / name for name in listed.stdout.split("\0") if name and (PROJECT / name).is_file()]
    return [
        path for folder in (*MAY_IMPORT, "tests") for path in (PROJECT / folder).rglob("*") if path.is_file()
    ]


def test_imports_of_reads_every_form_of_import():
    source = "import a.b\nfrom c import d\nfrom . import e\nfrom .f import g\ndef h():\n    import i"
    found = set(imports_of(ast.parse(source), "here"))
    assert found == {"a.b", "c", "c.d", "here", "here.e", "here.f", "here.f.g", "i"}


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_package_imports_only_what_is_below_it(package):
    files = source_files(package)
    assert files, f"package {package} has no files"
    for path in files:
        name = path.relative_to(PROJECT).as_posix()
        ours = {module.split(".")[0] for module in imports(path)} & set(MAY_IMPORT)
        forbidden = ours - MAY_IMPORT[package] - {package} - COMMAND_LINE.get(name, set())
        assert not forbidden, f"{name} imports {', '.join(sorted(forbidden))}"


def test_command_line_imports_reports_only_inside_functions():
    for name, packages in COMMAND_LINE.items():
        path = PROJECT / name
        if not path.exists():
            continue
        module = ast.parse(path.read_text(encoding="utf-8"))
        top = ast.Module([n for n in module.body if isinstance(n, ast.Import | ast.ImportFrom)], [])
        eager = {found.split(".")[0] for found in imports_of(top, "cases")} & packages
        assert not eager, f"{name} imports {', '.join(eager)} before it knows the command"


@pytest.mark.parametrize(
    ("library", "home"), [("matplotlib", "reports/"), ("jinja2", "reports/"), ("meshio", "cases/files.py")]
)
def test_library_has_one_home(library, home):
    for package in MAY_IMPORT:
        for path in source_files(package):
            name = path.relative_to(PROJECT).as_posix()
            used = any(module.split(".")[0] == library for module in imports(path))
            assert not used or name.startswith(home), f"{name} imports {library}, which belongs to {home}"


@pytest.mark.parametrize("package", ["fdsolver", "tensionfield", "femref"])
def test_solvers_know_no_files_and_no_screen(package):
    for path in source_files(package):
        forbidden = {module.split(".")[0] for module in imports(path)} & NOT_IN_SOLVERS
        assert not forbidden, f"{path.relative_to(PROJECT)} imports {', '.join(sorted(forbidden))}"


def test_reports_run_no_solver():
    for path in source_files("reports"):
        forbidden = imports(path) & RUNS_A_SOLVER
        assert not forbidden, f"{path.relative_to(PROJECT)} imports {', '.join(sorted(forbidden))}"


@pytest.mark.parametrize("package", ["fdsolver", "tensionfield", "femref"])
def test_solvers_know_no_scene_names(package):
    scenes = {path.stem for path in (PROJECT / "cases" / "data").glob("*.toml")} - SHAPE_AND_EDGE_NAMES
    for path in source_files(package):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        strings = {
            n.value for n in ast.walk(tree) if isinstance(n, ast.Constant) and isinstance(n.value, str)
        }
        assert not strings & scenes, f"{path.relative_to(PROJECT)} names the scene {strings & scenes}"


def test_files_are_short_enough_to_read_at_once():
    folders = (*MAY_IMPORT, "tests")
    lengths = {
        p: p.read_text(encoding="utf-8").count("\n") for folder in folders for p in source_files(folder)
    }
    too_long = {str(p.relative_to(PROJECT)): n for p, n in lengths.items() if n > LONGEST_FILE}
    assert not too_long, f"files of more than {LONGEST_FILE} lines: {too_long}"


def test_no_tracked_file_names_a_place_on_some_machine():
    places = "|".join(["work", "home", "opt", "root", "tmp", "Users"])
    machine_path = re.compile(rf"(?<![\w.$)}}/-])/(?:{places})/\w|[A-Z]:\\\\?Users")
    assert machine_path.search("see " + "/".join(["", "home", "someone", "x"]))
    for path in tracked_files():
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:  # an image or another binary file
            continue
        hit = machine_path.search(text)
        line = text.count("\n", 0, hit.start()) + 1 if hit else 0
        assert hit is None, f"{path.relative_to(PROJECT)}:{line} names {hit.group()!r}"


def test_versions_are_exact_and_inside_the_ranges_of_the_project():
    lines = (PROJECT / "constraints.txt").read_text(encoding="utf-8").split()
    pinned = dict(line.split("==") for line in lines)
    assert all(re.fullmatch(r"[\w.-]+==[0-9][0-9a-z.]*", line) for line in lines)
    project = tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = [item for group in project["optional-dependencies"].values() for item in group]
    versions = {name.lower().replace("_", "-"): version for name, version in pinned.items()}
    for item in project["dependencies"] + extras:
        requirement = Requirement(item)
        assert requirement.specifier.contains(versions[requirement.name]), (
            f"{item}: {versions[requirement.name]}"
        )
