"""The controller's state from its variables; what a controller does not say is said to be unknown."""

from typing import Final

from catseye.drivers.kuka import names
from catseye.drivers.kuka.proxy import Proxy
from catseye.drivers.kuka.settings import KukaSettings
from catseye.drivers.kuka.values import flag_of, real_of, symbol_of, whole_of
from catseye.drivers.roles.robot import RobotStatus

MESSAGE: Final = 1
"""Alarm number of a message: no variable says which one it is."""

_MESSAGE_TEXT: Final = (
    "a message keeps programs from running; the controller tells no number over this protocol: read it on the "
    "smartPAD, remove its cause and confirm it"
)
_MANUAL: Final = frozenset({"T1", "T2"})


class StateReader:
    """Reads the state of one controller.

    Attributes:
        unknown: variables that the controller refused to read at the last look.
    """

    def __init__(self, settings: KukaSettings) -> None:
        self._settings = settings
        self.unknown: tuple[str, ...] = ()

    @property
    def knows_drives(self) -> bool:
        """The last look saw whether the drives are on."""
        return bool(self._settings.drives_variable) and self._settings.drives_variable not in self.unknown

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know about the state; empty when everything is known."""
        if not self.unknown:
            return ()
        named = ", ".join(self.unknown)
        return (f"unknown, since this controller does not read them: {named}; watch the smartPAD for them",)

    async def status(self, proxy: Proxy) -> RobotStatus:
        """Return the state; what is unknown counts as what lets nothing move by mistake, but for stop and message.

        Raises:
            RefusedError: the mode, the program's state or the override cannot be read.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        mode, program, override = await proxy.read_all((names.MODE, names.PROGRAM_STATE, names.OVERRIDE))
        settings = self._settings
        asked = [
            settings.drives_variable,
            settings.emergency_stop_variable,
            settings.message_variable,
            names.TAKEN,
            names.DONE,
        ]
        known = await proxy.read_known([name for name in asked if name])
        self.unknown = tuple(name for name, text in known.items() if text is None)
        drives, no_stop, message = (
            None if (text := known.get(name)) is None else flag_of(text) for name in asked[:3]
        )
        taken, done = (None if (text := known[name]) is None else whole_of(text) for name in asked[3:])
        active = symbol_of(program) == names.ACTIVE
        return RobotStatus(
            servo_on=active if drives is None else drives,
            running=active and taken != done,
            operation_enabled=active and taken is not None,
            teach_mode=symbol_of(mode) in _MANUAL,
            emergency_stop=no_stop is False,
            override_percent=real_of(override),
            alarm_number=MESSAGE if message else 0,
            alarm_text=_MESSAGE_TEXT if message else "",
            program=names.PROGRAM if taken is not None else "",
        )


def rest_text(status: RobotStatus, *, drives_are_known: bool) -> str:
    """Return what holds an arm whose program was told to stop, and what whoever goes to it does before."""
    seen = "on" if status.servo_on else "off"
    drives = seen if drives_are_known else "on or off, which this controller does not say"
    return (
        f"{names.PROGRAM} is held by {names.STOP} and takes no order, {names.OVERRIDE} is "
        f"{status.override_percent:g} %, the drives are {drives}: no variable switches them, so that only the "
        "controller does, in its own time; before anybody goes to the arm, switch them off at the smartPAD or by the "
        "cell's own controls"
    )
