"""Start of the command line against another one of the same environment, by CPU time: neighbours do not count."""

import resource
import statistics
import subprocess
import sys

from tests.system.command import environment

ROUNDS = 7
TARGET_S = 0.3
MOST = 1.5
"""Of what `pytest --version` takes, which plans nothing and measures nothing either."""


def spent_s() -> float:
    """Return the CPU time of all processes that were waited for, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run_s(*arguments: str) -> float:
    """Return what a run takes, s of CPU."""
    before_s = spent_s()
    subprocess.run([sys.executable, *arguments], env=environment(), capture_output=True, check=True)
    return spent_s() - before_s


def test_help_takes_no_longer_than_another_command() -> None:
    commands = ("-m", "catseye", "--help"), ("-m", "pytest", "--version"), ("-c", "pass")
    for command in commands:
        run_s(*command)
    taken = [[run_s(*command) for command in commands] for _ in range(ROUNDS)]
    help_s, pytest_s, bare_s = (statistics.median(column) for column in zip(*taken, strict=True))
    print(  # noqa: T201  # the figure
        f"\ncatseye --help: {help_s:.2f} s of CPU (target {TARGET_S:g} s), pytest --version: {pytest_s:.2f} s, bare "
        f"interpreter: {bare_s:.2f} s; {help_s / pytest_s:.2f} × pytest (limit {MOST:g} ×)"
    )
    assert help_s <= MOST * pytest_s
