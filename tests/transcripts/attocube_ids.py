"""JSON-RPC of attocube's displacement sensors.

Source: the maker's open Python client, as its files send and read; one generation is in the PyPI package
feather-xrol. Requests have no terminator, answers end with CR LF.
"""

NEWER_REQUEST = (
    b'{"jsonrpc": "2.0", "method": "com.attocube.sen.displacement.getAxisDisplacement", "api": 2, "pid": "sen", '
    b'"params": [0], "id": 7}'
)
OLDER_REQUEST = b'{"jsonrpc": "2.0", "method": "com.attocube.ids.system.getCurrentMode", "api": 2, "id": 8}'

MODE_ANSWER = b'{"jsonrpc": "2.0", "result": [0, "measurement running"], "id": 8}\r\n'
BARE_MODE_ANSWER = b'{"jsonrpc": "2.0", "result": "measurement running", "id": 8}\r\n'
DISPLACEMENT_ANSWER = b'{"jsonrpc": "2.0", "result": [0, -1234567890], "id": 7}\r\n'
"""-1.23456789 mm, in pm."""
