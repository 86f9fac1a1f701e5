"""Which device a run was made with, as its record says."""

from collections.abc import Mapping
from typing import Any


def device_identity(meta: Mapping[str, Any], name: str) -> str:
    """Return what tells a device of a run from others of its model; empty where it states no serial number.

    Args:
        meta: of the run; a changed one may have stored anything.
        name: of the device: robot, interferometer, tracker.
    """
    devices = meta.get("devices")
    identity = devices.get(name) if isinstance(devices, Mapping) else None
    if not isinstance(identity, Mapping) or not identity.get("serial"):
        return ""
    return f"{identity.get('model')} {identity['serial']}"
