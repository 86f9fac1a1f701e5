"""A program that holds a key: it takes control, begins a jog or a walk and feeds until it is killed.

Arguments: path of the engine's socket, joint or `walk`. A line on stdout says that a joint moves, or the walk is fed.
"""

import sys
import time
from typing import Any

from tests.system.socket_client import Lines

FEED_S = 0.05


def hold(client: Lines, joint: str, direction: int) -> dict[str, Any]:
    """Feed once; what a busy machine did not set going within the time of one feed is asked for anew."""
    while True:
        answer = client.ask("jog-hold", joint=joint, direction=direction)
        if answer["ok"] or "not fed any more" not in answer["error"]:
            return answer


def feed(path: str, joint: str) -> None:
    """Feed for ever."""
    client = Lines(path)
    client.ask("hello", client="feeder", who="Ada")
    client.ask("control")
    begun = client.ask("jog", on=True, percent=5.0)
    assert begun["ok"], begun
    while True:
        fed = hold(client, joint, 1)
        assert fed["ok"], fed
        if fed.get("moving"):
            sys.stdout.write("moving\n")
            sys.stdout.flush()
        time.sleep(FEED_S)


def walk(path: str) -> None:
    """Walk for ever."""
    client = Lines(path)
    client.ask("hello", client="feeder", who="Ada")
    client.ask("control")
    begun = client.ask("start", procedure="open-loop", search="none", walk=True)
    assert begun["ok"], begun
    client.until(event="state", state="EXECUTE")
    while True:
        assert client.ask("walk-feed")["ok"]
        sys.stdout.write("moving\n")
        sys.stdout.flush()
        time.sleep(FEED_S)


if __name__ == "__main__":
    place, what = sys.argv[1:]
    if what == "walk":
        walk(place)
    else:
        feed(place, what)
