"""Coverage-guided fuzzing of scenes, studies and changes: python -m tests.faults.fuzz_scene -max_total_time=120.

Needs atheris, which nothing else here does. The options are libFuzzer's; it ends with the first input that is neither
accepted nor refused with sentences, and prints it.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["cases", "tomllib"]):
    from cases.scene import SceneError, load_scene, scene_toml
    from cases.study_file import load_study

FOLDER = Path(tempfile.mkdtemp(prefix="fuzz-"))
BEGINNING = b'sheet.shape = "annulus"\nedges.inner.support = "pinned"\n'


def one_input(content: bytes) -> None:
    """Read the bytes as what their first byte says; anything but SceneError and sentences is a finding."""
    kind, rest = content[:1], content[1:]
    file = FOLDER / "fuzzed.toml"
    try:
        if kind == b"s":
            file.write_bytes(rest)
            load_study(file)
        elif kind == b"c":
            load_scene("annulus", rest.decode("utf-8", "replace").split("\n"))
        else:
            file.write_bytes((BEGINNING if kind == b"b" else b"") + rest)
            accepted = scene_toml(load_scene(file))
            file.write_text(accepted, encoding="utf-8")
            if scene_toml(load_scene(file)) != accepted:
                raise AssertionError("an accepted scene is another one when it is read again")
    except SceneError as refusal:
        for problem in refusal.problems:
            if not (problem.message and str(problem).isprintable()):
                raise AssertionError(f"no sentence: {problem!r}") from refusal


if __name__ == "__main__":
    atheris.Setup(sys.argv, one_input)
    atheris.Fuzz()
