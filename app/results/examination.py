"""The devices of a cell as a report: who answers, its status, what to do."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from catseye.app.results.model import Report, Section, Sign, Statement, section
from catseye.app.results.origin import origin_now

if TYPE_CHECKING:
    from catseye.app.protocol.examination import CellExamination, DeviceExamination


def examination_report(examination: "CellExamination") -> Report:
    """Return one section a device."""
    sections = tuple(_device_section(device) for device in examination.devices)
    return Report(f"Devices of {examination.cell}", origin_now(), sections)


def _healed(reasons: Sequence[str]) -> tuple[Statement, ...]:
    """Return how often a link was healed and why at last."""
    if not reasons:
        return ()
    return (Statement(Sign.ATTENTION, f"its link was healed {len(reasons)}×, at last because {reasons[-1]}"),)


def _device_section(device: "DeviceExamination") -> Section:
    emulated = " (EMULATED)" if device.simulated else ""
    identity = f"{device.identity}{emulated}" if device.identity else "nobody answers as this device would"
    return section(
        device.device,
        f"{device.device}: {device.endpoint}",
        [
            Statement(Sign.GOOD if device.ok else Sign.BAD, identity),
            *(Statement(Sign.NEUTRAL, text) for text in device.status),
            *_healed(device.healed),
            *(Statement(Sign.ATTENTION, text) for text in device.advice),
        ],
        brief=True,
    )
