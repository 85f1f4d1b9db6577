"""The command line's words and options; nothing here imports more than argparse."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

BAD_INPUT = 2


class Refused(Exception):
    """The command line cannot be understood; the message says why."""


class Parser(argparse.ArgumentParser):
    """A parser whose mistakes are one sentence."""

    def __init__(self, **options: Any) -> None:
        super().__init__(allow_abbrev=False, **options)

    def error(self, message: str) -> NoReturn:
        """Raise Refused instead of printing the usage."""
        # argparse quotes words as they came: what a terminal would obey must not reach it
        printable = "".join(letter if letter.isprintable() else "?" for letter in message)
        raise Refused(f"{printable} (see `{self.prog} --help`)")


class _Version(argparse.Action):
    """`--version`, looked up only when it is asked for."""

    def __call__(self, *_: Any) -> None:
        from cases.machine import version_of

        print(f"wrinklebench {version_of('wrinklebench') or '(not installed, run from the sources)'}")
        sys.exit(0)


def parse(argv: Sequence[str]) -> argparse.Namespace:
    """The command and its options. Raises Refused; `--help` and `--version` print and raise SystemExit(0)."""
    parser, commands = build()
    if argv and not argv[0].startswith("-") and argv[0] not in commands:
        guess = _guess(argv[0], list(commands))
        raise Refused(f"there is no command {_word(argv[0])}{guess}; there are {', '.join(commands)}")
    if argv and argv[0] in commands:
        _refuse_unknown_options(argv[1:], commands[argv[0]])
    arguments = parser.parse_args(list(argv))
    if arguments.command is None:
        parser.print_help()
        sys.exit(0)
    return arguments


def _refuse_unknown_options(words: Sequence[str], command: Parser) -> None:
    """Name an unknown option and its nearest neighbour; argparse would first miss what it stands for."""
    known = list(command._option_string_actions)
    for word in words:
        option = word.partition("=")[0]
        if option.startswith("--") and len(option) > 2 and option not in known:
            raise Refused(f"{command.prog} has no option {_word(option)}{_guess(option, known)}")


def build() -> tuple[Parser, dict[str, Parser]]:
    """The parser, and those of its commands by name."""
    parser = Parser(prog="wrinkle", description="Wrinkling of thin sheets by several independent methods.")
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", title="commands", parser_class=Parser)
    made = {
        "list": commands.add_parser("list", help="the scenes, with title, methods, default nodes"),
        "run": _run(commands.add_parser("run", help="one solve into one result folder")),
        "compare": _compare(
            commands.add_parser("compare", help="one scene by several methods, with differences")
        ),
        "report": _report(
            commands.add_parser("report", help="all scenes, all methods: index.html and report.pdf")
        ),
        "plan": _plan(
            commands.add_parser(
                "plan", help="effects, wavelength, nodes and cost of a scene before it is solved"
            )
        ),
        "cost": _cost(commands.add_parser("cost", help="error against time for every method and mesh")),
        "study": _study(
            commands.add_parser("study", help="a parameter study: one result per point, one table")
        ),
        "hard": _hard(commands.add_parser("hard", help="the table of hard cases, with verdicts")),
        "doctor": _doctor(commands.add_parser("doctor", help="versions, cores, cache, what is missing")),
    }
    for name, command in made.items():
        command.description = f"wrinkle {name}: {_description(commands, name)}"
    return parser, made


def _description(commands: Any, name: str) -> str:
    return next(action.help for action in commands._choices_actions if action.dest == name)


def _run(parser: Parser) -> Parser:
    _scene(parser)
    parser.add_argument(
        "--method", required=True, metavar="M", help="tension-field, membrane, koiter, exact or auto"
    )
    _numbers(parser)
    parser.add_argument(
        "--accuracy", metavar="1%", help="choose nodes and tolerance for this estimated error"
    )
    parser.add_argument(
        "--strict",
        action="store_true",
        help="exit 4 if wrinkles have fewer than 6 nodes or an effect was wrongly left out",
    )
    parser.add_argument("--out", metavar="DIR", help="result folder (default: runs/SCENE-METHOD)")
    parser.add_argument(
        "--resume", action="store_true", help="go on from the checkpoint, past a step or time limit"
    )
    parser.add_argument("--force", action="store_true", help="replace another result in the folder")
    parser.add_argument("--quiet", action="store_true", help="no progress display")
    return parser


def _compare(parser: Parser) -> Parser:
    _scene(parser)
    parser.add_argument(
        "--methods", metavar="A,B,..", help="methods, separated by commas (default: all that fit)"
    )
    _numbers(parser)
    parser.add_argument("--out", metavar="DIR", help="folder (default: runs/SCENE-compare)")
    parser.add_argument(
        "--resume", action="store_true", help="go on from checkpoints, past a step or time limit"
    )
    parser.add_argument("--force", action="store_true", help="replace other results in the folder")
    parser.add_argument("--quiet", action="store_true", help="no progress display")
    return parser


def _report(parser: Parser) -> Parser:
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--quick", action="store_true", help="at most 10 minutes on two cores (default)")
    size.add_argument("--full", action="store_true", help="the paper's node counts: at most 60 minutes")
    parser.add_argument("--scenes", metavar="A,B,..", help="only these scenes, separated by commas")
    parser.add_argument("--out", metavar="DIR", help="folder (default: report)")
    parser.add_argument("--quiet", action="store_true", help="no progress display")
    return parser


def _plan(parser: Parser) -> Parser:
    _scene(parser)
    parser.add_argument(
        "--method", default="auto", metavar="M", help="tension-field, membrane, koiter or auto (default)"
    )
    parser.add_argument(
        "--accuracy", metavar="1%", help="relative error of the energy that the mesh must allow"
    )
    return parser


def _cost(parser: Parser) -> Parser:
    _scene(parser)
    parser.add_argument("--methods", metavar="A,B,..", help="methods (default: all that fit)")
    parser.add_argument("--nodes", metavar="N,M,..", help="meshes (default: 1000 to 64000)")
    parser.add_argument("--seconds", metavar="S", help="time limit of each run (default: 120)")
    parser.add_argument("--repeats", metavar="N", default="3", help="runs of each short case (default: 3)")
    parser.add_argument(
        "--no-options", action="store_true", help="leave out other dampings, masses and so on"
    )
    parser.add_argument("--out", metavar="DIR", help="folder (default: runs/SCENE-cost)")
    parser.add_argument("--quiet", action="store_true", help="no progress lines")
    return parser


def _study(parser: Parser) -> Parser:
    parser.add_argument("study", metavar="STUDY", help="a built-in study or a TOML file")
    parser.add_argument("--jobs", metavar="N", help="processes at a time (default: one per core)")
    parser.add_argument("--cluster", metavar="slurm", help="hand the points to this queue (needs submitit)")
    parser.add_argument("--out", metavar="DIR", help="folder (default: runs/STUDY-study)")
    parser.add_argument("--resume", action="store_true", help="go on past step and time limits")
    parser.add_argument("--quiet", action="store_true", help="no progress lines")
    return parser


def _hard(parser: Parser) -> Parser:
    parser.add_argument("--families", metavar="A,B,..", help="only these families, separated by commas")
    parser.add_argument("--out", metavar="DIR", help="folder (default: runs/hard)")
    parser.add_argument("--quiet", action="store_true", help="no progress lines")
    return parser


def _doctor(parser: Parser) -> Parser:
    parser.add_argument("--bench", action="store_true", help="measure the throughput of the kernels")
    return parser


def _scene(parser: Parser) -> None:
    parser.add_argument("scene", metavar="SCENE", help="a built-in scene or a TOML file")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="change a key, as edges.inner.move_mm=[0,0,80]",
    )


def _numbers(parser: Parser) -> None:
    parser.add_argument("--nodes", metavar="N", help="number of nodes (default: the scene's)")
    parser.add_argument("--seed", default="0", metavar="S", help="of the random start (default: 0)")
    parser.add_argument("--threads", default="1", metavar="T", help="threads (default: 1)")
    parser.add_argument("--tol", metavar="X", help="residual to reach (default: the scene's or the method's)")


def _guess(word: str, choices: list[str]) -> str:
    from cases.problems import did_you_mean

    return did_you_mean(word, choices)


def _word(word: str) -> str:
    from cases.problems import shown

    return shown(word)
