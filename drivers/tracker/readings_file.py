"""A tracker with a program of its own, which writes its readings into a table: the rows of a growing text file.

A reading is the row that comes after it was asked for: rows that come while nobody waits belong to no pose and are
passed over. A program that exports its whole list anew each time is as good as one that appends to it.
"""

import asyncio
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar, Final, Self

from pydantic import Field

from catseye.drivers.links.driver import DeviceSettings
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Examination, Identity, Sink
from catseye.drivers.roles.errors import HiddenTargetError, LinkError, ProtocolError, RefusedError
from catseye.drivers.roles.text_table import Decimal, Dialect, Encoding, Separator
from catseye.drivers.roles.tracker import (
    Face,
    Place,
    Position,
    TargetPoint,
    TargetPose,
    Tracker,
    TrackerAbilities,
)
from catseye.drivers.roles.user_file import read_regular
from catseye.drivers.tracker.mapped_row import (
    AngleUnit,
    Columns,
    LengthUnit,
    Mirrored,
    Row,
    Turns,
    likely_mistake,
    parse_row,
)

_SCHEME: Final = "file:"
_LARGEST_BYTES: Final = 1 << 26
MODEL: Final = "tracker's file"


class ReadingsSettings(DeviceSettings):
    """What a cell file may set: how the file is written, and which column is what."""

    separator: Separator = Field(
        default=",", description="between the columns: comma, semicolon, tab or blank."
    )
    decimal: Decimal = Field(default=".", description="sign before the decimals.")
    header_lines: int = Field(default=1, ge=0, le=10_000, description="lines above the first row.")
    encoding: Encoding = Field(default="utf-8", description="of the text.")
    target_column: int | None = Field(
        default=None, ge=1, le=1000, description="place of the target's name, from 1; None without one."
    )
    x_column: int = Field(default=1, ge=1, le=1000, description="place of x, from 1.")
    y_column: int = Field(default=2, ge=1, le=1000, description="place of y, from 1.")
    z_column: int = Field(default=3, ge=1, le=1000, description="place of z, from 1.")
    rx_column: int | None = Field(
        default=None, ge=1, le=1000, description="place of rx; None in a file of points."
    )
    ry_column: int | None = Field(default=None, ge=1, le=1000, description="place of ry.")
    rz_column: int | None = Field(default=None, ge=1, le=1000, description="place of rz.")
    u_column: int | None = Field(
        default=None, ge=1, le=1000, description="place of the standard uncertainty of a coordinate."
    )
    visible_column: int | None = Field(
        default=None, ge=1, le=1000, description="place of the number of marks that were seen of the tool."
    )
    base_visible_column: int | None = Field(
        default=None, ge=1, le=1000, description="place of the number of marks that were seen of the base."
    )
    length_unit: LengthUnit = Field(default="mm", description="of coordinates and uncertainty.")
    angle_unit: AngleUnit = Field(default="deg", description="of rotations.")
    mirrored: Mirrored = Field(
        default="none", description="axis whose sign makes a left-handed frame right-handed."
    )
    turns: Turns = Field(default="fixed-axes", description="R = Rz·Ry·Rx, or moving axes: R = Rx·Ry·Rz.")
    u_mm: float | None = Field(
        default=None, gt=0, description="standard uncertainty of a coordinate, where no column has it."
    )
    u_deg: float | None = Field(
        default=None, gt=0, description="standard uncertainty of each rotation of a pose; state it with u_mm."
    )
    tolerance_mm: float = Field(
        default=50.0, gt=0, description="how far a target may be from where it is expected."
    )
    row_timeout_s: float = Field(
        default=120.0, gt=0, description="how long a row may take beyond the dwell, s of the clock."
    )
    poll_s: float = Field(default=0.2, gt=0, description="how often the file is looked at, s of the clock.")

    @property
    def dialect(self) -> Dialect:
        """How the file is written."""
        return Dialect(self.separator, self.decimal, self.header_lines, self.encoding)

    @property
    def columns(self) -> Columns:
        """Which column is what."""
        rx, ry, rz = self.rx_column, self.ry_column, self.rz_column
        return Columns(
            (self.x_column, self.y_column, self.z_column),
            None if rx is None or ry is None or rz is None else (rx, ry, rz),
            self.target_column,
            self.u_column,
            self.visible_column,
            self.base_visible_column,
            self.length_unit,
            self.angle_unit,
            self.mirrored,
            self.turns,
        )


class ReadingsFile(Tracker):
    """Tracker driver.

    Args:
        path: of the file, which may come into being later.
    """

    Settings: ClassVar[type[ReadingsSettings]] = ReadingsSettings
    protocols: ClassVar[Mapping[str, str] | None] = {}
    abilities: ClassVar[TrackerAbilities] = TrackerAbilities(points=True, poses=True)
    summary: ClassVar[str] = "any tracker whose program writes a text file, or a person who does"

    def __init__(self, path: Path, clock: Clock, settings: ReadingsSettings | None = None) -> None:
        self._path = path
        self._clock = clock
        self._settings = settings or ReadingsSettings()
        self._turn = asyncio.Lock()

    @classmethod
    def at(cls, endpoint: str, clock: Clock, sink: Sink | None = None, **settings: Any) -> Self:
        """Return a driver for a file, `file:///folder/readings.csv`; nothing is opened yet.

        Raises:
            LinkError: the endpoint names no file.
            pydantic.ValidationError: a setting is unknown or wrong.
        """
        del sink
        checked = ReadingsSettings(**settings)
        return cls(path_of(endpoint), clock, checked)

    async def connect(self) -> Identity:
        """Check that there is a folder in which the file is, or will be.

        Raises:
            LinkError: there is none, or the file cannot be read.
        """
        await self._lines()
        return Identity(f"{MODEL} {self._path.name}", "", "", simulated=False)

    async def close(self) -> None:
        """Do nothing; the file is open only while it is read."""

    async def locate(self) -> Position:
        """Return x and y of the next row; its frame has to be level.

        Raises:
            HiddenTargetError: no row comes.
            RefusedError: neither file nor settings say how uncertain a place is.
            DeviceError: the file cannot be used.
        """
        seen = await self.point("", 0.0)
        if seen.u_mm is None:
            raise RefusedError(f"{self._where}: state u_mm or u_column in [tracker.settings]", 0)
        return Position(seen.place_mm[0], seen.place_mm[1], max(seen.u_mm))

    async def point(
        self, target: str, dwell_s: float, near_mm: Place | None = None, face: Face = 1
    ) -> TargetPoint:
        """Return the place in the row that comes next; the tracker's own program averages.

        Raises:
            HiddenTargetError: no row comes.
            RefusedError: the row is of another target, far from where it is expected, or one of several.
            ProtocolError: the row does not fit the mapping.
            LinkError: the file cannot be read.
        """
        if face != 1:
            raise RefusedError(f"{self._where}: a file does not tell in which face {target} was measured", 0)
        row = await self._next(target, dwell_s)
        self._check_place(target, row.place_mm, near_mm)
        return TargetPoint(row.place_mm, self._u_mm(row))

    async def pose(self, target: str, dwell_s: float) -> TargetPose:
        """Return the pose in the row that comes next; as `point` else."""
        row = await self._next(target, dwell_s)
        if row.turn_deg is None:
            raise RefusedError(
                f"{self._where}: a file of points: state rx_column, ry_column and rz_column in [tracker.settings]",
                0,
            )
        u_deg = self._settings.u_deg
        return TargetPose(
            row.place_mm,
            row.turn_deg,
            row.visible,
            base_visible=row.base_visible,
            u_mm=self._u_mm(row),
            u_deg=None if u_deg is None else (u_deg, u_deg, u_deg),
        )

    async def examine(self) -> Examination:
        """Say how many rows the file has and what the last one says."""
        rows = await self._lines()
        if not rows:
            return Examination((f"no row yet in {self._path}",))
        try:
            last = parse_row(rows[-1], self._settings.dialect, self._settings.columns)
        except ProtocolError as error:
            return Examination((f"{len(rows)} rows",), (f"{self._where}: the last row: {error}",))
        x, y, z = last.place_mm
        return Examination(
            (f"{len(rows)} rows, the last {last.target} x {x:.4f}, y {y:.4f}, z {z:.4f} mm".strip(),)
        )

    @property
    def _where(self) -> str:
        return f"{MODEL} {self._path}"

    async def _next(self, target: str, dwell_s: float) -> Row:
        """Wait for the row that comes after this moment."""
        async with self._turn:
            line = await self._awaited(target, await self._lines(), dwell_s)
        try:
            row = parse_row(line, self._settings.dialect, self._settings.columns)
        except ProtocolError as error:
            raise ProtocolError(f"{self._where}: row {line[:80]!r}: {error}") from None
        if row.target != target and self._settings.target_column is not None and target:
            raise RefusedError(
                f"{self._where}: a row of {row.target!r} came while {target!r} was waited for: measure that one, or "
                "give both the same name",
                0,
            )
        return row

    async def _awaited(self, target: str, before: list[str], dwell_s: float) -> str:
        until_s = self._clock.monotonic_s() + dwell_s + self._settings.row_timeout_s
        seen: list[str] | None = None
        while True:
            now = await self._lines()
            new = _new_rows(before, now, seen)
            seen = now
            if len(new) > 1:
                raise RefusedError(
                    f"{self._where}: {len(new)} rows came for {target or 'one target'}: write one row for each "
                    "measurement when it is asked for",
                    0,
                )
            if new:
                return new[0]
            if self._clock.monotonic_s() >= until_s:
                raise HiddenTargetError(
                    f"{self._where}: no row of {target or 'a target'} came within "
                    f"{dwell_s + self._settings.row_timeout_s:g} s: measure it and have its row written into the file"
                )
            await self._clock.sleep(self._settings.poll_s)

    async def _lines(self) -> list[str]:
        """Return the rows of the file that are whole: each ends in an end of line.

        Raises:
            LinkError: the file cannot be read; one that is not there yet has no rows.
        """
        try:
            raw = await asyncio.to_thread(_read, self._path)
            text = raw.decode(self._settings.dialect.codec)
        except (OSError, UnicodeDecodeError) as error:
            raise LinkError(
                f"{self._where}: cannot be read ({error}): check the path in [tracker] endpoint, and the encoding"
            ) from None
        whole = text.rpartition("\n")[0].splitlines()[self._settings.header_lines :]
        return [line for line in whole if line.strip() and not line.lstrip().startswith("#")]

    def _u_mm(self, row: Row) -> Place | None:
        u_mm = row.u_mm or self._settings.u_mm
        return None if u_mm is None else (u_mm, u_mm, u_mm)

    def _check_place(self, target: str, place_mm: Place, near_mm: Place | None) -> None:
        """Refuse a place far from where it is expected, and name the likely mistake."""
        if near_mm is None:
            return
        tolerance_mm = self._settings.tolerance_mm
        off_mm = math.dist(place_mm, near_mm)
        if off_mm > tolerance_mm:
            mistake = likely_mistake(place_mm, near_mm, tolerance_mm) or "look which target was measured"
            raise RefusedError(
                f"{self._where}: {target} is {off_mm:.1f} mm from where it is expected: {mistake}", 0
            )


def path_of(endpoint: str) -> Path:
    """Return the path that an endpoint names.

    Raises:
        LinkError: it names none.
    """
    path = endpoint.removeprefix(_SCHEME).removeprefix("//")
    if not endpoint.startswith(_SCHEME) or not path:
        raise LinkError(f"endpoint {endpoint!r}: write file:///folder/readings.csv")
    return Path(path)


def _new_rows(before: list[str], now: list[str], seen: list[str] | None) -> list[str]:
    """Return the rows that have come since.

    Args:
        before: rows when the wait began.
        now: rows at this look.
        seen: rows at the look before; None at the first.
    """
    if now[: len(before)] == before:
        return now[len(before) :]
    # Some of the rows that were there: the list is just being written anew.
    if before[: len(now)] == now:
        return []
    # Another file, once it has come to rest.
    return now if now == seen else []


def _read(path: Path) -> bytes:
    if not path.exists() and path.parent.is_dir():
        return b""
    return read_regular(path, _LARGEST_BYTES)
