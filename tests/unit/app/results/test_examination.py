"""The devices of a cell as a report and as data."""

import pytest

from catseye.app.protocol.examination import CellExamination, DeviceExamination
from catseye.app.render.text import report_text
from catseye.app.results.examination import examination_report

ROBOT = DeviceExamination(
    device="robot",
    endpoint="tcp://127.0.0.1:10001",
    ok=False,
    identity="CR800",
    simulated=True,
    status=["servo off"],
    advice=["alarm 60: reset it"],
)


def test_a_device_has_its_identity_facts_and_advice() -> None:
    report = examination_report(CellExamination(cell="lab-1", devices=[ROBOT]))
    assert report_text(report).splitlines() == [
        "Devices of lab-1",
        "",
        "robot: tcp://127.0.0.1:10001",
        "  ✗ CR800 (EMULATED)",
        "  · servo off",
        "  ! alarm 60: reset it",
    ]


def test_a_healed_link_is_counted_with_its_last_reason() -> None:
    device = ROBOT.model_copy(update={"healed": ["no answer", "garbage b'!'"]})
    text = report_text(examination_report(CellExamination(cell="lab-1", devices=[device])))
    assert "! its link was healed 2×, at last because garbage b'!'" in text


@pytest.mark.parametrize(("ok", "identity"), [(True, "CR800"), (False, "")])
def test_the_sign_says_whether_a_device_can_be_used(ok: bool, identity: str) -> None:
    device = ROBOT.model_copy(update={"ok": ok, "identity": identity, "simulated": False})
    verdict = examination_report(CellExamination(cell="lab-1", devices=[device])).statements()[0]
    assert verdict.sign == ("good" if ok else "bad")
    assert verdict.text == (identity or "nobody answers as this device would")


def test_data_keep_their_keys() -> None:
    data = CellExamination(cell="lab-1", devices=[ROBOT]).model_dump(mode="json")
    assert set(data) == {"cell", "devices", "warnings"}
    keys = ["device", "endpoint", "ok", "identity", "simulated", "status", "advice", "healed"]
    assert list(data["devices"][0]) == keys
