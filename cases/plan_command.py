"""The command `wrinkle plan`: prints the plan of a run."""

from __future__ import annotations

import argparse

from cases.interrupt import Interruption


def plan_scene(arguments: argparse.Namespace, _: Interruption) -> int:
    """Print effects, wrinkles, mesh, cost and warnings of a scene. Raises SceneError and MethodError."""
    from cases.accuracy import read_accuracy
    from cases.plan import lines, plan
    from cases.scene import load_scene

    scene = load_scene(arguments.scene, arguments.set)
    accuracy = None if arguments.accuracy is None else read_accuracy(arguments.accuracy)
    for line in lines(plan(scene, arguments.method, accuracy)):
        print(line)
    return 0
