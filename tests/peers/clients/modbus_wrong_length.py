"""Read with the package modbus-client: `modbus_wrong_length.py PORT`; prints what it gave."""

import json
import sys

from modbus_client.modbus_client import Client

client = Client("127.0.0.1", int(sys.argv[1]), unit_id=1)
client.s.settimeout(5.0)
said = {
    "read": client.read_holding_registers(0, 4),
    "read_again": Client("127.0.0.1", int(sys.argv[1]), unit_id=1).read_input_registers(0, 4),
}
print("\n" + json.dumps(said))  # noqa: T201  # data for the test
