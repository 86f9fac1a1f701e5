"""Put every critical fault into a copy of the program, one at a time; exit code 1 where one is not caught."""

import argparse
import sys
import time

from tests.mutations.critical import ALL
from tests.mutations.trial import Outcome, copied, passes, put_in


def main() -> int:
    """Try the faults that are named, or all."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutations", description=__doc__)
    parser.add_argument(
        "name", nargs="*", choices=[[], *(each.name for each in ALL)], help="faults to try [all]"
    )
    wanted = parser.parse_args().name
    chosen = [each for each in ALL if not wanted or each.name in wanted]
    wrong = 0
    with copied() as root:
        tests = sorted({test for each in chosen for test in each.tests})
        if passes(root, tests) is not Outcome.SURVIVED:
            print("the tests fail without any fault: mend them first")  # noqa: T201  # the figures
            return 1
        for mutation in chosen:
            began_s = time.monotonic()
            with put_in(mutation, root):
                outcome = passes(root, mutation.tests)
            wrong += outcome is not Outcome.CAUGHT
            took_s = time.monotonic() - began_s
            print(f"{mutation.name}: {outcome.value} ({took_s:.0f} s)", flush=True)  # noqa: T201  # the figures
    print(f"{len(chosen) - wrong} of {len(chosen)} faults caught")  # noqa: T201  # the figures
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
