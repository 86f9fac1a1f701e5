"""Send a place through the data link with melfapy: `data_link.py PORT X Y Z A B C`."""

import json
import sys

from melfapy.Melfa import MelfaDatalink

link = MelfaDatalink([float(value) for value in sys.argv[2:]])
link.listen(("127.0.0.1", int(sys.argv[1])))
print("\n" + json.dumps(link.as_comma()))  # noqa: T201  # data for the test
