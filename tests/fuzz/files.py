"""Every kind of file that a person gives the program: a valid one, and what reads it.

A new kind of file needs one entry in `KINDS`.
"""

import json
import math
import struct
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

from catseye.app.campaign.load import load_campaign, shipped
from catseye.app.cell.arm import arm_description, shipped_arm
from catseye.app.cell.load import load_cell
from catseye.app.cell.serial_arm import chain_of, loads_of
from catseye.app.cell.templates import TEMPLATES
from catseye.app.cell.tool import read_tool
from catseye.app.cell.wizard.draft import Draft
from catseye.app.cli.report import _report_of_files  # noqa: PLC2701  # the report of any result file
from catseye.app.errors import UsageError
from catseye.app.files.documents import read_text
from catseye.app.files.poses import poses_table, read_poses
from catseye.app.files.tabular import table_parquet
from catseye.app.files.target_deviations import read_target_deviations
from catseye.app.render.text import report_text
from catseye.app.results.mapping import read_mapping
from catseye.app.results.resolution.input_files import RecordingFile, read_moves, read_recording
from catseye.app.results.resolution.joint_tables import read_joint_tables, write_joint_tables
from catseye.app.results.resolution.predicted import write_predicted
from catseye.app.results.resolution.recording_mapping import (
    RecordingMapping,
    found_mapping,
    read_mapped_recording,
)
from catseye.app.results.resolution.result import resolution_text
from catseye.app.results.resolution.torque_file import read_torque
from catseye.app.results.scara.distances import load_distances
from catseye.app.results.scara.instrument_positions import preview_positions
from catseye.app.results.scara.measured import measured_path
from catseye.app.results.scara.path_csv import read_path_csv
from catseye.app.results.scara.result import result_text
from catseye.app.results.serial_arm.anchors import read_anchors
from catseye.app.results.serial_arm.measured_poses import read_measured_poses
from catseye.app.results.serial_arm.nominal_arm import serial_arm_of
from catseye.app.results.serial_arm.priors import read_priors
from catseye.app.results.serial_arm.result import serial_arm_text
from catseye.app.results.stored_results import stored_result
from catseye.app.service.running import read_answers
from catseye.app.store.seal import MANIFEST, read_manifest
from catseye.app.testing.replay import load_transcript
from catseye.app.tui.keys import read_keymap
from catseye.drivers.counter.profile import built_in_text, load_profile
from catseye.procedures.scara.path.instrument_file import PositionsMapping
from catseye.simulators.config import TruthText
from catseye.simulators.world.scara.truth import true_arm
from catseye.simulators.world.serial.true_arm import true_serial_arm
from tests.unit.app.results.resolution.recordings import decaying_commands, write_test
from tests.unit.app.results.resolution.sample import sample_prediction, sample_result, sample_tables
from tests.unit.app.results.scara import sample
from tests.unit.app.results.serial_arm.sample import sample_calibration
from tests.unit.app.results.serial_arm.tables import poses_file, some_poses, tool_file
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.kuka.benches import kuka_config
from tests.unit.simulators.world.serial.arms import exact_arm

NOMINAL = (325.0, 225.0)


@dataclass(frozen=True)
class Kind:
    """A kind of file.

    Attributes:
        name: of the file, whose end says what is in it.
        make: writes what a valid one holds, and the files beside it, into a folder.
        read: reads it as a command does.
    """

    name: str
    make: Callable[[Path], bytes]
    read: Callable[[Path], object]

    @property
    def loads(self) -> Callable[[bytes], Any] | None:
        """What makes a document of it, whose values are changed too; None where it is no document."""
        match Path(self.name).suffix:
            case ".toml":
                return lambda raw: tomllib.loads(raw.decode())
            case ".json":
                return json.loads
        return None

    def dumped(self, document: Any) -> bytes:
        """Return the bytes of a document."""
        if self.name.endswith(".json"):
            return json.dumps(document).encode()
        if not isinstance(document, dict):
            return str(document).encode(errors="surrogateescape")
        return tomlkit.dumps(_without_nothing(document)).encode(errors="surrogateescape")


def _without_nothing(value: Any) -> Any:
    """Return what TOML can hold: it has no null and no integers beyond 64 bits."""
    match value:
        case dict():
            return {key: _without_nothing(each) for key, each in value.items() if each is not None}
        case list():
            return [_without_nothing(each) for each in value if each is not None]
        case _:
            return value


def of_text(text: str) -> Callable[[Path], bytes]:
    return lambda _folder: text.encode()


POINTS = "reflector,segment,theta1_deg,theta2_deg,direction1,direction2,displacement_mm,sigma_mm\n" + "".join(
    f"P{1 + number % 3},{number // 9},{number - 20.0},{30.0 + number},1,-1,{0.125 * number},0.001\n"
    for number in range(20)
)
PATH = "theta1_deg,theta2_deg,direction1,direction2\n" + "".join(
    f"{8.0 + number},{100.0 - number},1,-1\n" for number in range(12)
)
PLACES = "x_mm,y_mm,line\n" + "".join(
    f"{300.0 + number},{200.0 - number},{1 + number // 6}\n" for number in range(12)
)
DRAWN = """[[segment]]
kind = "line"
from = [350.0, -100.0]
to = [350.0, 100.0]
points = 11
"""


def _measured_row(number: int) -> str:
    one, two = 8.0 + 6.0 * number, 100.0 - 7.0 * number
    first, both = math.radians(one), math.radians(one + two)
    x_mm = NOMINAL[0] * math.cos(first) + NOMINAL[1] * math.cos(both)
    y_mm = NOMINAL[0] * math.sin(first) + NOMINAL[1] * math.sin(both)
    return f"{one},{two},1,-1,{x_mm:.4f},{y_mm:.4f},0.01\n"


MEASURED = "theta1_deg,theta2_deg,direction1,direction2,x_meas_mm,y_meas_mm,u_mm\n" + "".join(
    map(_measured_row, range(12))
)
POSITIONS = "Name;X [mm];Y [mm];Z [mm];State\n" + "".join(
    f'"point {number}";{1000 + 3 * number},5;{200 - number},25;{-640 + number},0;ok\n' for number in range(12)
)
POSES = "pose,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n" + "".join(
    f"P{number},{number},{-90 + number},{90 - number},0,30,{number}\n" for number in range(8)
)
ANCHORS = "anchor,x_mm,y_mm,z_mm,u_mm\ncup1,100.0,200.0,300.0,0.01\ncup2,,,,0.01\n"
PRIORS = "name,u,value\nJ2.a_mm,0.1,\nJ3.d_mm,0.2,1.5\n"
TORQUE = "t_s,torque_nm\n" + "".join(f"{0.012 * number:.3f},{1.5 + number}\n" for number in range(40))
TRACE_CSV = "Zeit(s);Torque_A1(Nm)\n" + "".join(
    f"{0.012 * number:.3f};{1.5 + number}\n".replace(".", ",") for number in range(40)
)
LASER = "Laser 1\n\nZeit (ms);Abstand (µm)\n" + "".join(
    f"{number},0;{number * 2.5}\n".replace(".", ",") for number in range(40)
)
MAPPING = """format = "catseye-mapping/1"
separator = ";"
decimal = ","
header_lines = 3
encoding = "utf-8"
[columns]
t_s = {column = 1, unit = "ms", sign = 1}
displacement_mm = {column = 2, unit = "um", sign = 1}
"""
TARGETS = "\r\n".join(
    [
        "HEADER::",
        "File type   :Linear",
        "TARGET DATA::",
        "Target-count: 4",
        "Targets :",
        "0.0 0.1",
        "0.2 0.3",
        "Flags: 0",
        "RUNS::",
        "Run-count: 2",
        "DEVIATIONS::",
        "Run Target Data:",
        *(f"  {run}   {target}   {run * target / 10:.6f}" for run in (1, 2) for target in (1, 2, 3, 4)),
        "EQUIPMENT::",
        "",
    ]
)
TRACE = (
    "DIAEXTENDED  {@:ENGLISH\n\n#BEGINGLOBALHEADER\n  1,WINDOWS\n112,High -> Low\n#ENDGLOBALHEADER\n"
    "#BEGINCHANNELHEADER\n200,Zeit\n202,s\n210,IMPLIZIT\n220,3\n240,1.5\n241,0.012\n#ENDCHANNELHEADER\n"
    "#BEGINCHANNELHEADER\n200,Torque_A1\n202,[Nm]\n210,EXPLIZIT\n211,TRACE.R64\n213,BLOCK\n214,REAL64\n"
    "220,3\n221,1\n240,0.5\n241,2.0\n#ENDCHANNELHEADER\n"
)
VALUES = struct.pack("<3d", 1.0, 2.0, -3.0)
TRANSCRIPT = "".join(
    json.dumps(
        {"t": "2026-01-01T00:00:00", "device": "robot", "direction": way, "hex": "514f4b", "text": "QoK"}
    )
    + "\n"
    for way in ("tx", "rx", "heal")
)
HASH = "0" * 64
SEALED = json.dumps(
    {
        "format": "catseye-manifest/1",
        "run": "a",
        "created_utc": "now",
        "files": {"x": {"sha256": HASH, "bytes": 1}},
    }
)  # fmt: skip - as a reader would look for it


def _cell(system: str) -> Kind:
    return Kind("cell.toml", of_text(TEMPLATES[system].text), load_cell)


def _draft(system: str) -> Kind:
    return Kind("cell.toml", of_text(TEMPLATES[system].text), lambda path: Draft.of_text(read_text(path)))


def _arm(path: Path) -> object:
    description = arm_description(str(path))
    return chain_of(description), loads_of(description)


def _arm_text(name: str) -> str:
    return (files("catseye.app.cell") / "arms" / f"{name}.toml").read_text("utf-8")


def _with_cell(folder: Path) -> bytes:
    (folder / "cell.toml").write_text(TEMPLATES["scara"].text, encoding="utf-8")
    return POINTS.encode()


def _parquet_points(folder: Path) -> bytes:
    _with_cell(folder)
    head, *rows = (line.split(",") for line in POINTS.splitlines())
    typed = [
        [row[0], int(row[1]), *map(float, row[2:4]), *map(int, row[4:6]), *map(float, row[6:])]
        for row in rows
    ]
    return table_parquet([dict(zip(head, row, strict=True)) for row in typed], {})


def _points(path: Path) -> object:
    return load_distances([], path, path.parent / "cell.toml", None)


def _truth(path: Path) -> object:
    return true_arm(TruthText(path.read_bytes(), str(path)), QUIET)


def _serial_truth(path: Path) -> object:
    config = replace(kuka_config(), truth=TruthText(path.read_bytes(), str(path)))
    return true_serial_arm(exact_arm("kr210-r2700"), config)


def _true_drives() -> bytes:
    truth = kuka_config().truth
    assert truth is not None
    return truth.raw


def _transcript(path: Path) -> object:
    try:
        return load_transcript(path)
    except ValueError as error:
        # What a test gets to see, and no command.
        raise UsageError(str(error)) from error


def _report(path: Path) -> object:
    stored_result(path)
    return report_text(_report_of_files([path]))


def _with_result(path: Path) -> object:
    return report_text(_report_of_files([path.parent / "a1.json", path]))


def _measured_poses(folder: Path) -> bytes:
    tool_file(folder)
    return poses_file(folder, some_poses(9)).read_bytes()


def _read_measured_poses(path: Path) -> object:
    description = shipped_arm("irb120")
    arm = serial_arm_of(description, read_tool(path.parent / "plate.toml"))
    return read_measured_poses([path], description, arm, {})


def _recording(folder: Path) -> bytes:
    commands = decaying_commands(4)
    return write_test(
        folder, commands.tolist(), np.cumsum(commands).tolist(), rate_hz=50.0
    ).recording.read_bytes()


def _moves(folder: Path) -> bytes:
    commands = decaying_commands(4)
    return write_test(
        folder, commands.tolist(), np.cumsum(commands).tolist(), rate_hz=50.0
    ).moves.read_bytes()


def _foreign_recording(path: Path) -> object:
    return read_mapped_recording(path, found_mapping(path))


def _tables(folder: Path) -> bytes:
    write_joint_tables(sample_tables(), folder / "made.csv", simulated=True)
    return (folder / "made.csv").read_bytes()


def _prediction(folder: Path) -> bytes:
    (folder / "a1.json").write_text(resolution_text(sample_result()), encoding="utf-8")
    write_predicted(sample_prediction(), folder / "made.csv.json")
    return (folder / "made.csv.json").read_bytes()


def _trace(folder: Path) -> bytes:
    (folder / "trace.r64").write_bytes(VALUES)
    return TRACE.encode("latin-1")


def _trace_values(folder: Path) -> bytes:
    (folder / "trace.dat").write_text(TRACE, encoding="latin-1")
    return VALUES


def _joints() -> list[str]:
    return [f"A{number}" for number in range(1, 7)]


KINDS: dict[str, Kind] = {
    "cell of a SCARA": _cell("scara"),
    "cell of six axes": _cell("six-axis"),
    "cell of motion resolution": _cell("resolution"),
    "draft of a SCARA": _draft("scara"),
    "draft of six axes": _draft("six-axis"),
    "arm of ABB": Kind("arm.toml", of_text(_arm_text("irb120")), _arm),
    "arm of KUKA": Kind("arm.toml", of_text(_arm_text("kr210-r2700")), _arm),
    "tool": Kind("plate.toml", lambda folder: tool_file(folder).read_bytes(), read_tool),
    "answers": Kind("answers.toml", of_text('"beam/P1/0042" = "retry"\ndoor = true\n'), read_answers),
    "keys": Kind("keys.toml", of_text('"go.jog" = "f5,j"\n"run.hold" = "h"\n'), read_keymap),
    "counter profile": Kind(
        "own.toml", of_text(built_in_text("default")), lambda path: load_profile(str(path))
    ),
    "campaign": Kind("day.toml", lambda _folder: shipped()["scara-day"].read_bytes(), load_campaign),
    "mapping of a recording": Kind(
        "laser.toml", of_text(MAPPING), lambda path: read_mapping(RecordingMapping, path)
    ),
    "mapping of positions": Kind(
        "tracker.toml",
        of_text(
            MAPPING.replace("t_s =", "x_meas_mm =")
            .replace("displacement_mm", "y_meas_mm")
            .replace("ms", "mm")
        ),
        lambda path: read_mapping(PositionsMapping, path),
    ),
    "points": Kind("points.csv", _with_cell, _points),
    "points as Parquet": Kind("points.parquet", _parquet_points, _points),
    "path of joints": Kind("path.csv", of_text(PATH), lambda path: read_path_csv(path, NOMINAL)),
    "path of places": Kind(
        "path.csv", of_text(PLACES), lambda path: read_path_csv(path, NOMINAL, "right", None)
    ),
    "drawn path": Kind("path.toml", of_text(DRAWN), lambda path: read_path_csv(path, NOMINAL)),
    "measured path": Kind(
        "measured.csv", of_text(MEASURED), lambda path: measured_path(path, NOMINAL, "right", (1, 1))
    ),
    "positions of a tracker": Kind(
        "points.txt", of_text(POSITIONS), lambda path: preview_positions(path, None)
    ),
    "result of a SCARA": Kind(
        "result.json", lambda _folder: result_text(sample.hand_made()).encode(), _report
    ),
    "truth of a SCARA": Kind("truth.json", lambda _folder: result_text(sample.hand_made()).encode(), _truth),
    "poses": Kind("poses.csv", of_text(POSES), lambda path: read_poses(path, poses_table(["deg"] * 6))),
    "measured poses": Kind("measured.csv", _measured_poses, _read_measured_poses),
    "anchors": Kind("anchors.csv", of_text(ANCHORS), read_anchors),
    "priors": Kind("priors.csv", of_text(PRIORS), read_priors),
    "result of six axes": Kind(
        "arm.json", lambda _folder: serial_arm_text(sample_calibration()).encode(), _report
    ),
    "truth of six axes": Kind("truth.json", lambda _folder: _true_drives(), _serial_truth),
    "recording": Kind("laser.csv", _recording, lambda path: read_recording(RecordingFile(path))),
    "recording of another program": Kind("laser.csv", of_text(LASER), _foreign_recording),
    "moves": Kind("moves.csv", _moves, read_moves),
    "torque": Kind("torque.csv", of_text(TORQUE), read_torque),
    "trace as CSV": Kind("trace.csv", of_text(TRACE_CSV), read_torque),
    "trace of a controller": Kind("trace.dat", _trace, read_torque),
    "values of a trace": Kind("trace.r64", _trace_values, lambda path: read_torque(path.with_suffix(".dat"))),
    "target deviations": Kind("axis.rtl", of_text(TARGETS), read_target_deviations),
    "result of motion resolution": Kind(
        "a1.json", lambda _folder: resolution_text(sample_result()).encode(), _report
    ),
    "tables of joints": Kind("tables.csv", _tables, lambda path: read_joint_tables(path, _joints())),
    "predicted resolution": Kind("predicted.json", _prediction, _with_result),
    "transcript": Kind("wire.log", of_text(TRANSCRIPT), _transcript),
    "manifest": Kind(MANIFEST, of_text(SEALED), lambda path: read_manifest(path.parent)),
}
