"""The command `wrinkle` (the same as `python -m cases`): from words to functions, from errors to exit codes.

Exit codes: 0 done; 1 the machine failed (disk, memory, an unforeseen error); 2 bad input, nothing written;
3 and 4 the status of a single solve (`fdsolver.result.Status`); 130 interrupted.

Imports are inside the functions: `--help` must not wait for the compiler. `wrinkle report` is the one place
where this package calls `reports`, which is built on top of it.
"""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from collections.abc import Sequence

from cases.arguments import BAD_INPUT, Refused, parse
from cases.interrupt import Interruption, interruptible

MACHINE_FAILED = 1
INTERRUPTED = 130


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command. Returns its exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    try:
        arguments = parse(words)
        with interruptible() as interruption:
            code = _command(arguments, interruption)
            sys.stdout.flush()
            return code
    except Refused as refusal:
        return _complain([str(refusal)], BAD_INPUT)
    except KeyboardInterrupt:
        return _complain([_how_to_resume(words)], INTERRUPTED)
    except BrokenPipeError:
        # The reader of our output has gone (`| head`); the interpreter must not write to it again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except MemoryError:
        return _complain(["there is not enough memory; ask for fewer nodes"], MACHINE_FAILED)
    except Exception as error:
        sentences = _foreseen(error)
        if sentences is None:
            raise
        return _complain(sentences, MACHINE_FAILED if isinstance(error, OSError) else BAD_INPUT)


def _command(arguments: argparse.Namespace, interruption: Interruption) -> int:
    if arguments.command == "report":
        return _report(arguments, interruption)
    if arguments.command == "study":
        from cases.study_command import study

        return study(arguments, interruption)
    if arguments.command == "hard":
        from cases.hard_command import hard

        return hard(arguments, interruption)
    if arguments.command == "plan":
        from cases.plan_command import plan_scene

        return plan_scene(arguments, interruption)
    if arguments.command == "cost":
        from cases.cost_command import cost_of_accuracy

        return cost_of_accuracy(arguments, interruption)
    from cases import commands

    run = {
        "list": commands.list_scenes,
        "run": commands.run_scene,
        "compare": commands.compare_methods,
        "doctor": commands.doctor,
    }[arguments.command]
    return run(arguments, interruption)


def _report(arguments: argparse.Namespace, interruption: Interruption) -> int:
    from cases.commands import out_folder, words_of
    from cases.machine import usable_cores
    from cases.progress import display
    from reports.command import PROCESSES, report
    from reports.plan import report_runs

    scenes = None if arguments.scenes is None else words_of(arguments.scenes, "--scenes")
    try:
        report_runs(arguments.full, scenes)
    except ValueError as unknown:
        raise Refused(f"--scenes: {unknown}") from None
    out = out_folder(arguments.out, "report")
    with display(arguments.quiet) as progress:
        processes = min(PROCESSES, usable_cores())
        return report(out, arguments.full, scenes, None, interruption.watch(progress), processes)


def _foreseen(error: Exception) -> list[str] | None:
    """The sentences for an error of input or machine; None for one of ours, which needs its traceback."""
    from cases.problems import SceneError

    if isinstance(error, SceneError):
        return [str(problem) for problem in error.problems]
    if isinstance(error, OSError):
        return [str(error) if error.filename is None else f"{error.filename}: {error.strerror}"]
    from cases.folders import FolderRefused
    from cases.memory import TooManyNodes
    from cases.methods import MethodError
    from cases.probe import ProbeError
    from cases.results import ResultError
    from fdsolver.checkpoint import CheckpointError
    from fdsolver.grid import GridError
    from tensionfield.annulus_problem import NoAnnulusSolution

    refusals = (
        MethodError,
        FolderRefused,
        TooManyNodes,
        ResultError,
        ProbeError,
        GridError,
        CheckpointError,
        NoAnnulusSolution,
    )
    return [str(error)] if isinstance(error, refusals) else None


def _complain(sentences: Sequence[str], code: int) -> int:
    for sentence in sentences:
        print(f"wrinkle: {sentence}", file=sys.stderr)
    return code


def _how_to_resume(words: Sequence[str]) -> str:
    again = shlex.join(["wrinkle", *words])
    resumable = bool(words) and words[0] in ("run", "compare", "report", "study", "hard", "cost")
    return f"interrupted; finished results are kept, `{again}` goes on" if resumable else "interrupted"


if __name__ == "__main__":
    sys.exit(main())
