"""Shared by the tests: files, and the command line that the package is compared with."""

import json
import os
import subprocess
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
SAMPLES = REPOSITORY / "assets" / "samples"
MODEL = SAMPLES / "mannequin.glb"
MOTION = SAMPLES / "walk.bvh"


def text_of_cli(*arguments: object, status: int = 0) -> str:
    """Runs the command line and returns what it prints."""
    program = os.environ.get("GAITWAY_CLI", REPOSITORY / "target" / "debug" / "gaitway")
    command = [str(argument) for argument in (program, *arguments)]
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=False)
    assert done.returncode == status, done.stderr
    return done.stdout


def cli(*arguments: object, status: int = 0) -> dict:
    """Runs the command line with --json and returns its document."""
    return json.loads(text_of_cli(*arguments, "--json", status=status))
