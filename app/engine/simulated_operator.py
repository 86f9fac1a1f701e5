"""The hands of the emulated operator: they do on an emulated bench what a question asks for."""

import asyncio
import json
from collections.abc import Mapping
from pathlib import Path
from urllib.parse import urlsplit

from catseye.app.errors import LinkFailedError
from catseye.procedures.kit.records import Json
from catseye.procedures.kit.tasks import (
    AlignOptics,
    ClearBeam,
    ExportBallbar,
    LeadTracker,
    MountArtefact,
    MountBallbar,
    MountInterferometer,
    MountOptics,
    PlaceReflector,
    PlaceTarget,
    ReadBallbar,
    ReadIndicator,
    SeatInCup,
    SetUpScaleBar,
    TakeBallbarOff,
    TakeIndicatorOff,
    TapArtefact,
    Task,
    TaskAtAnAxis,
    TaskInTheRoom,
    TurnScrew,
)

_LIMIT_S = 10.0
"""Real seconds that one grip may take."""

_TRIAL_TURNS = 0.8
"""To either side of where a screw stands, to see how the signal changes."""

_LONGEST_ANSWER_BYTES = 1 << 22
"""A recording of half an hour."""

NO_READING = "none"
"""What is typed where an instrument shows no number."""


_SingleGrip = (
    TurnScrew | PlaceReflector | MountInterferometer | MountOptics | ClearBeam | TaskAtAnAxis | TaskInTheRoom
)


class SimulatedOperator:
    """Turns screws, carries reflectors and remounts the interferometer through the control port of an emulated bench.

    Args:
        endpoint: of the control port, `tcp://host:port`.
        clumsy: turn every screw the wrong way, as an operator may who looks at it from below.
    """

    def __init__(self, endpoint: str, *, clumsy: bool = False) -> None:
        self._endpoint = endpoint
        self._sense = -1.0 if clumsy else 1.0

    async def do(self, task: Task) -> dict[str, Json]:
        """Carry a task out.

        Returns:
            What was really asked of the bench.

        Raises:
            LinkFailedError: the bench does not answer, or cannot do it.
        """
        if isinstance(task, AlignOptics):
            return {"op": "align_optics", **{screw: await self._aligned(screw) for screw in ("pitch", "yaw")}}
        request = self._request(task)
        await self._done(request)
        return request

    async def bench(self) -> dict[str, Json]:
        """Return what tells this start of the bench and its true arm from any other; empty where nobody says."""
        try:
            answer = await self._ask({"op": "identify"})
        except LinkFailedError:
            answer = {}
        return {f"bench_{key}": str(answer.get(key) or "") for key in ("started", "truth")}

    async def read(self, task: ReadBallbar | ReadIndicator) -> str:
        """Return what somebody reads from an instrument and types: mm or µm, or "none" where it shows no number.

        Raises:
            LinkFailedError: the bench does not answer.
        """
        if isinstance(task, ReadIndicator):
            shown = (await self._done(_at_an_axis(task))).get("reading_um")
            return f"{shown:g}" if isinstance(shown, int | float) else NO_READING
        shown = (await self._done(_in_the_room(task))).get("deviation_mm")
        return f"{shown:.4f}" if isinstance(shown, int | float) else NO_READING

    async def export(self, path: Path) -> dict[str, Json]:
        """Write what the ballbar has recorded, unless such a file is there already.

        Returns:
            What was asked of the bench; nothing where the file is there.

        Raises:
            LinkFailedError: the bench does not answer, or the file cannot be written.
        """
        if await asyncio.to_thread(path.exists):
            return {}
        request = _in_the_room(ExportBallbar())
        text = _recording_text(await self._done(request))
        try:
            await asyncio.to_thread(path.write_text, text, encoding="utf-8")
        except OSError as error:
            raise LinkFailedError(
                f"{path}: the recording of the emulated ballbar cannot be written ({error}); type another path"
            ) from error
        return request

    async def _aligned(self, screw: str) -> float:
        """Turn a screw of the optics' stage to where the signal is at its largest; return by how much.

        Like a person, it knows nothing but the signal: on either side of where the screw stands, and there. The
        square of what the signal lacks is a parabola in the screw's turns.
        """
        at, up, down = [
            await self._lack_after(screw, turns) for turns in (0.0, _TRIAL_TURNS, -2.0 * _TRIAL_TURNS)
        ]
        curvature = up + down - 2.0 * at
        best = _TRIAL_TURNS * (down - up) / (2.0 * curvature) if curvature > 0.0 else 0.0
        await self._turned(screw, self._sense * best + _TRIAL_TURNS)
        return best

    async def _lack_after(self, screw: str, turns: float) -> float:
        """Return the square of what the signal lacks after a turn, 0 for a full one."""
        await self._turned(screw, turns)
        found = (await self._done({"op": "optics"})).get("miss")
        return found * found if isinstance(found, int | float) else 0.0

    async def _turned(self, screw: str, turns: float) -> None:
        if turns:
            await self._done({"op": "turn_screw", "screw": screw, "turns": turns})

    async def _done(self, request: Mapping[str, Json]) -> dict[str, Json]:
        answer = await self._ask(request)
        if answer.get("ok") is not True:
            raise LinkFailedError(
                f"the emulated bench at {self._endpoint} refused {request}: {answer.get('error')}; put the cell "
                "file beside the emulator in order, or answer the question otherwise"
            )
        return answer

    def _request(self, task: _SingleGrip) -> dict[str, Json]:
        match task:
            case TurnScrew():
                return {"op": "turn_screw", "screw": task.screw, "turns": self._sense * task.turns}
            case PlaceReflector():
                return {"op": "place_reflector", "reflector": task.reflector}
            case MountInterferometer():
                return {"op": "mount_interferometer", "turned_deg": task.turned_deg}
            case MountOptics(optics="angular"):
                return {"op": "mount_angular_optics", "joint": task.on}
            case MountOptics():
                return {"op": "mount_linear_optics", "axis": task.on}
            case ClearBeam():
                return {"op": "clear_beam"}
            case MountArtefact() | TapArtefact() | ReadIndicator() | TakeIndicatorOff():
                return _at_an_axis(task)
            case _:
                return _in_the_room(task)

    async def _ask(self, request: Mapping[str, Json]) -> dict[str, Json]:
        try:
            where = urlsplit(self._endpoint)
            async with asyncio.timeout(_LIMIT_S):
                reader, writer = await asyncio.open_connection(
                    where.hostname, where.port, limit=_LONGEST_ANSWER_BYTES
                )
                try:
                    writer.write(json.dumps(request).encode() + b"\n")
                    answer = json.loads(await reader.readline())
                finally:
                    writer.close()
                    await writer.wait_closed()
        except (OSError, TimeoutError, ValueError) as error:
            raise LinkFailedError(
                f"the emulated bench at {self._endpoint} ([tracker] of the cell file) does not do {request}: "
                f"{str(error) or 'no answer'}; is catseye emulate running with this cell file?"
            ) from error
        if not isinstance(answer, dict):
            raise LinkFailedError(f"{self._endpoint} is not a control port of an emulated bench: {answer!r}")
        return answer


def _at_an_axis(task: TaskAtAnAxis) -> dict[str, Json]:
    match task:
        case MountArtefact():
            return {"op": "mount_artefact", "joint": task.joint, "turned": task.turned}
        case TapArtefact():
            return {"op": "tap_artefact", "by_um": task.by_um}
        case ReadIndicator():
            return {"op": "indicator", "direction": task.direction}
        case TakeIndicatorOff():
            return {"op": "take_indicator_off"}


def _in_the_room(task: TaskInTheRoom) -> dict[str, Json]:
    match task:
        case SetUpScaleBar():
            x_mm, y_mm, z_mm = task.place_mm
            return {
                "op": "set_up_scale_bar",
                "x_mm": x_mm,
                "y_mm": y_mm,
                "z_mm": z_mm,
                "turn_deg": task.turn_deg,
            }
        case PlaceTarget():
            return {"op": "place_target", "target": task.target}
        case LeadTracker():
            return {"op": "lead_tracker", "target": task.target}
        case SeatInCup():
            return {"op": "place_cup", "target": task.target}
        case MountBallbar():
            centre: Json = None if task.centre_mm is None else list(task.centre_mm)
            return {"op": "mount_ballbar", "target": task.target, "centre_mm": centre}
        case TakeBallbarOff():
            return {"op": "take_ballbar_off"}
        case ReadBallbar():
            return {"op": "ballbar"}
        case ExportBallbar():
            return {"op": "ballbar_recording"}


def _recording_text(recorded: Mapping[str, Json]) -> str:
    columns = [recorded.get("t_s"), recorded.get("deviation_mm")]
    times, deviations = (one if isinstance(one, list) else [] for one in columns)
    rows = [f"{time},{deviation}" for time, deviation in zip(times, deviations, strict=True)]
    return "\n".join(["t_s,deviation_mm", *rows]) + "\n"
