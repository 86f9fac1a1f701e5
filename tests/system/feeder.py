"""A program that holds a jog key: it takes control, begins to jog and feeds until it is killed.

Arguments: path of the engine's socket, joint. A line on stdout says that the joint moves.
"""

import sys
import time

from tests.system.socket_client import Lines

FEED_S = 0.05


def feed(path: str, joint: str) -> None:
    """Feed for ever."""
    client = Lines(path)
    client.ask("hello", client="feeder", who="Ada")
    client.ask("control")
    begun = client.ask("jog", on=True, percent=5.0)
    assert begun["ok"], begun
    while True:
        fed = client.ask("jog-hold", joint=joint, direction=1)
        assert fed["ok"], fed
        if fed.get("moving"):
            sys.stdout.write("moving\n")
            sys.stdout.flush()
        time.sleep(FEED_S)


if __name__ == "__main__":
    feed(*sys.argv[1:])
