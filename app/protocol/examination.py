"""Who answers behind each endpoint of a cell, as `catseye doctor --json` writes it."""

from pydantic import BaseModel


class DeviceExamination(BaseModel):
    """What was found out about one device.

    Attributes:
        device: its name in the cell file.
        endpoint: where it was looked for.
        ok: it can be used.
        identity: who answers; empty where nobody does.
        simulated: it is an emulator; None where nobody answered who could say it.
        status: facts, as text.
        advice: what to do.
        healed: why its links were healed meanwhile, once for each time.
    """

    device: str
    endpoint: str
    ok: bool = False
    identity: str = ""
    simulated: bool | None = None
    status: list[str] = []
    advice: list[str] = []
    healed: list[str] = []


class CellExamination(BaseModel):
    """The devices of a cell.

    Attributes:
        cell: its name.
        devices: each of them, or the one that was asked for.
        warnings: values of the cell file that are hardly meant.
    """

    cell: str
    devices: list[DeviceExamination]
    warnings: list[str] = []
