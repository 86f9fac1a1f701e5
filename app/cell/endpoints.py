"""Endpoints as a cell file writes them."""

from catseye.drivers.links.endpoint import parse_endpoint


def checked_endpoint(text: str) -> str:
    """Return an endpoint that can be connected to or emulated.

    Raises:
        DeviceError: it is none.
    """
    # Port 0 asks an emulator for a free port; as a place to connect to it means nothing.
    parse_endpoint(
        text[:-2] + ":1" if text.startswith(("tcp://", "udp://")) and text.endswith(":0") else text
    )
    return text
