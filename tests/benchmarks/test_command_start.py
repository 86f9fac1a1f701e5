"""Start of the command line against a bare interpreter."""

import statistics
import subprocess
import sys
import time

from tests.system.command import environment

ROUNDS = 9


def run_s(*arguments: str) -> float:
    start_s = time.perf_counter()
    subprocess.run([sys.executable, *arguments], env=environment(), capture_output=True, check=True)
    return time.perf_counter() - start_s


def test_help_within_a_third_of_a_second() -> None:
    run_s("-m", "catseye", "--help")
    pairs = [(run_s("-m", "catseye", "--help"), run_s("-c", "pass")) for _ in range(ROUNDS)]
    ours, bare = (statistics.median(column) for column in zip(*pairs, strict=True))
    print(f"\ncatseye --help: {ours:.2f} s, bare interpreter: {bare:.2f} s (limit 0.3 s)")  # noqa: T201  # the figure
    assert ours <= 0.3
