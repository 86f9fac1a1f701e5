"""Read and write variables with py_openshowvar: `kuka_variables.py PORT`; prints what came."""

import json
import sys
from typing import Any

from py_openshowvar import openshowvar

client = openshowvar("127.0.0.1", int(sys.argv[1]))


def read(name: str) -> Any:
    """Return a variable's text, None where the client says so."""
    given = client.read(name, debug=False)
    return given if given is None else given.decode()


def write(name: str, value: str) -> Any:
    """Return what the proxy made of a value."""
    given = client.write(name, value, debug=False)
    return given if given is None else given.decode()


said = {
    "reachable": client.can_connect,
    "ping": read("PING"),
    "proxy": read("@PROXY_TYPE"),
    "axes": read("$AXIS_ACT"),
    "measured": read("$AXIS_ACT_MEAS"),
    "place": read("$POS_ACT"),
    "override": [write("$OV_PRO", "20"), read("$OV_PRO")],
    "mode": read("$MODE_OP"),
    "unknown": read("$NOBODY"),
    "protected": write("$MODE_OP", "#T1"),
    "nonsense": write("$OV_PRO", "a lot"),
    "again": read("$OV_PRO"),
}
client.close()
print("\n" + json.dumps(said))  # noqa: T201  # data for the test
