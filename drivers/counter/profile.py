"""Profiles of line counters: what they are asked, what they answer, what it means."""

import difflib
import re
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, model_validator

from catseye.drivers.roles.errors import ProfileError
from catseye.drivers.roles.user_file import read_regular, toml_table

_BUILT_IN = "catseye.drivers.counter.profiles"


def _check_regex(text: str) -> str:
    try:
        re.compile(text)
    except (re.error, OverflowError, RecursionError) as exc:
        raise ValueError(f"not a regular expression: {exc}") from None
    return text


Regex = Annotated[str, AfterValidator(_check_regex)]
Command = Annotated[str, Field(min_length=1, max_length=80, pattern=r"^[\x1b\x20-\x7e]+$")]
Bit = Annotated[int, Field(ge=0, le=31)]


class _Table(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


class _Asked(_Table):
    """A question; `reply` names the groups that carry the answer."""

    command: Command
    reply: Regex

    def _require_group(self, name: str) -> Self:
        if name not in re.compile(self.reply).groupindex:
            raise ValueError(f"reply has no group (?P<{name}>...)")
        return self


class Line(_Table):
    """The lines themselves.

    Attributes:
        terminator: behind each command.
        echo: each command comes back as a line before its answer.
        strip: codes of characters that are dropped.
        gap_s: pause before each command, s.
        timeout_s: for an answer, real s.
    """

    terminator: Literal["\r", "\n", "\r\n", ""] = "\r\n"
    encoding: Literal["ascii", "latin-1", "utf-8"] = "ascii"
    echo: bool = False
    strip: list[Annotated[int, Field(ge=0, le=31)]] = [2, 3, 17, 19]
    gap_s: float = Field(default=0.0, ge=0)
    timeout_s: float = Field(default=1.0, gt=0)


class Query(_Asked):
    """The displayed value; groups `value` and, if the unit is sent, `unit`."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        return self._require_group("value")


class Zero(_Table):
    """How the count is zeroed.

    Attributes:
        mode: `device` sends a command, `software` keeps an offset.
        reply: what a success looks like; empty when no answer comes.
    """

    mode: Literal["device", "software"] = "device"
    command: Command | None = None
    reply: Regex = ""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.mode == "device" and not self.command:
            raise ValueError('mode = "device" needs a command')
        return self


class Bits(_Table):
    """Numbers of the status bits; a bit that the instrument does not have is left out."""

    beam_lost: Bit
    overspeed: Bit | None = None
    beam_absent: Bit | None = None
    laser_ready: Bit | None = None


class Status(_Asked):
    """The status bits; group `bits`.

    Attributes:
        radix: of the number in `bits`.
        bits: their numbers.
        inverted: those that mean the contrary.
    """

    radix: Literal[10, 16] = 16
    bits: Bits
    inverted: list[Literal["beam_lost", "overspeed", "beam_absent", "laser_ready"]] = []

    @model_validator(mode="after")
    def _check(self) -> Self:
        return self._require_group("bits")


class Signal(_Asked):
    """The level of the returning beam; group `value`.

    Attributes:
        full_scale: level that means 1.
    """

    full_scale: float = Field(default=100.0, gt=0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        return self._require_group("value")


class Identify(_Asked):
    """Who is there; group `model`."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        return self._require_group("model")


class Start(_Table):
    """Commands around a connection; whatever is answered to them is left aside.

    Attributes:
        first: sent as soon as the link is open, to silence a counter that was left sending by itself.
        init: sent after each opening of the link, once it is quiet.
        shutdown: sent before it is closed.
    """

    first: Command | None = None
    init: list[Command] = []
    shutdown: list[Command] = []


class Stream(_Table):
    """Values that come without being asked for.

    Attributes:
        mode: `none` asks for each value, `unsolicited` listens, `commands` starts and stops the stream.
        start: command that starts it.
        stop: command that stops it.
    """

    mode: Literal["none", "unsolicited", "commands"] = "none"
    start: Command | None = None
    stop: Command | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.mode == "commands") != (self.start is not None and self.stop is not None):
            raise ValueError('mode = "commands" needs start and stop, and no other mode takes them')
        return self


class Scale(_Table):
    """From the number to a length.

    Attributes:
        decimals: digits behind a decimal point that is not sent.
        count_mm: length of one count, mm; for unit `count`.
        sign: -1 when the number falls while the beam grows longer.
        wrap_bits: the count starts again after so many bits; 0 never.
    """

    unit: Literal["count", "nm", "um", "mm", "inch"] = "mm"
    decimals: int = Field(default=0, ge=0, le=12)
    count_mm: float | None = Field(default=None, gt=0)
    sign: Literal[1, -1] = 1
    wrap_bits: Literal[0, 16, 24, 32, 48] = 0

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.unit == "count") != (self.count_mm is not None):
            raise ValueError('unit = "count" needs count_mm, and no other unit takes it')
        if self.wrap_bits and self.unit != "count":
            raise ValueError('wrap_bits needs unit = "count"')
        if self.decimals and self.unit == "count":
            raise ValueError('unit = "count" has no decimals: put them into count_mm')
        return self


class Errors(_Table):
    """Lines that are no answer but an error."""

    patterns: list[Regex] = ["^E\\d", "^ERR", "^NG", "^\\?", "^NAK$", "^-{3}"]


class CounterProfile(_Table):
    """A line counter.

    Attributes:
        format: version of this layout.
        title: what to call the instrument.
        remark: what an operator has to know about the profile.
        confirmed: every value has been checked with the instrument's manual.
        compensated: `instrument` when it corrects for the air by itself.
        line: see there, as are the following.
        status: None when the instrument gives no status; an error in place of a value is a lost beam then.
    """

    format: Literal["catseye-counter/1"]
    title: str = Field(min_length=1, max_length=80)
    remark: str = ""
    confirmed: bool
    compensated: Literal["none", "instrument"]
    line: Line = Line()
    query: Query
    zero: Zero
    status: Status | None = None
    signal: Signal | None = None
    identify: Identify | None = None
    scale: Scale
    start: Start = Start()
    stream: Stream = Stream()
    errors: Errors = Errors()

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.stream.mode != "none" and (self.status or self.signal or self.zero.mode == "device"):
            raise ValueError(
                'nothing is asked during a stream: leave out status and signal, zero mode = "software"'
            )
        return self

    @property
    def claim(self) -> str:
        """What the profile is, with its remark."""
        return "; ".join(filter(None, (self.title, self.remark)))

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know; empty when every value is confirmed."""
        return () if self.confirmed or not self.claim else (self.claim,)


def built_in_profiles() -> tuple[str, ...]:
    """Return the names of the profiles that come with the program."""
    files = resources.files(_BUILT_IN).iterdir()
    return tuple(sorted(f.name.removesuffix(".toml") for f in files if f.name.endswith(".toml")))


def built_in_text(name: str) -> str:
    """Return a profile that comes with the program, comments included."""
    return (resources.files(_BUILT_IN) / f"{name}.toml").read_text("utf-8")


def load_profile(name_or_path: str) -> CounterProfile:
    """Read a profile.

    Args:
        name_or_path: name of a built-in profile, or path of a TOML file.

    Raises:
        ProfileError: not found, not TOML or wrong; the text names file, key and the nearest valid key.
    """
    if name_or_path in built_in_profiles():
        return parse_profile(built_in_text(name_or_path), f"built-in profile {name_or_path}")
    path = Path(name_or_path)
    try:
        text = read_regular(path).decode("utf-8")
    except (OSError, UnicodeDecodeError) as exc:
        raise ProfileError(
            f"counter profile {name_or_path!r} cannot be read ({exc}): give a TOML file or one of the built-in "
            f"profiles: {', '.join(built_in_profiles())}"
        ) from None
    return parse_profile(text, str(path))


def parse_profile(text: str, source: str) -> CounterProfile:
    """Read a profile's text.

    Args:
        source: file name, for texts.

    Raises:
        ProfileError: not TOML or wrong.
    """
    try:
        return CounterProfile.model_validate(toml_table(text))
    except ValidationError as exc:
        faults = "; ".join(_fault(error["loc"], error["type"], error["msg"]) for error in exc.errors())
        raise ProfileError(f"{source}: {faults}") from None
    except ValueError as exc:
        raise ProfileError(f"{source}: {exc}") from None


def _fault(loc: tuple[int | str, ...], kind: str, message: str) -> str:
    key = ".".join(map(str, loc))
    if kind != "extra_forbidden":
        return f"key {key}: {message}"
    near = difflib.get_close_matches(str(loc[-1]), _keys_beside(loc), n=1, cutoff=0.0)
    return f"key {key} is unknown, the nearest valid key is {near[0]!r}"


def _keys_beside(loc: tuple[int | str, ...]) -> list[str]:
    """Return the valid keys of the table in which a key stands."""
    table: Any = CounterProfile
    for name in loc[:-1]:
        annotation = table.model_fields[str(name)].annotation
        table = next(
            t for t in (annotation, *getattr(annotation, "__args__", ())) if hasattr(t, "model_fields")
        )
    return list(table.model_fields)
