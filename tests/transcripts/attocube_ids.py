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

EPICS_REQUEST = b'{"id":1,"jsonrpc":"2.0","method":"com.attocube.ids.displacement.getAxesDisplacement"}'
"""As nmarks99/attocubeIDS packs it (attocubeIDSApp/src/attocubeIDS.cpp, commit 420f99b5).

No `api`, keys sorted, every id 1; it reads up to a line feed. It takes the first three numbers of the result for the
axes, the error number among them, which the maker's own clients do not.
"""
