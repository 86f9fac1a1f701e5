"""The `catseye` command whose event loop can be blocked from outside: SIGUSR2 keeps it busy for some seconds."""

import runpy
import signal
import sys
import time

BLOCKED_S = 3.0


def _block(_number: int, _frame: object) -> None:
    time.sleep(BLOCKED_S)


if __name__ == "__main__":
    signal.signal(signal.SIGUSR2, _block)
    sys.argv[0] = "catseye"
    runpy.run_module("catseye", run_name="__main__", alter_sys=True)
