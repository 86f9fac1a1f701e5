"""Errors of the emulated IDS. Their numbers and texts are not public: all texts say EMULATOR."""

AXES = (0, 1, 2)

INTERRUPTED, WRONG_MODE, OUT_OF_RANGE, NO_SIGNAL, NO_UNIT, NO_TABLE, NOT_FITTED, WRONG_ADDRESS = range(1, 9)
LOCKED, WRONG_PASSWORD, NO_PACKAGE, NO_IMAGE, NO_INTERNET = range(9, 14)

_TEXTS = {
    0: "no error",
    INTERRUPTED: "beam interrupted",
    WRONG_MODE: "not possible in this mode",
    OUT_OF_RANGE: "parameter out of range",
    NO_SIGNAL: "no signal on this axis",
    NO_UNIT: "environment unit does not measure",
    NO_TABLE: "there is no such table: it has to be estimated first",
    NOT_FITTED: "not fitted",
    WRONG_ADDRESS: "network configuration is not valid",
    LOCKED: "the device is locked",
    WRONG_PASSWORD: "wrong password",
    NO_PACKAGE: "there is no such package",
    NO_IMAGE: "nothing was uploaded that can be installed here",
    NO_INTERNET: "no connection to the internet",
}

_BLANKS: dict[str, tuple[object, ...]] = {
    "adjustment.getContrastInPermille": (0, 0, 0),
    "displacement.getAbsolutePosition": (0,),
    "displacement.getAbsolutePositions": (0, 0, 0),
    "displacement.getAxesDisplacement": (0, 0, 0),
    "displacement.getAxisDisplacement": (0,),
    "displacement.getAxisSignalQuality": (0, 0),
    "displacement.getReferencePosition": (0,),
    "displacement.getReferencePositions": (0, 0, 0),
    "displacement.getSignalQuality": (0, 0),
    "nlc.getAnalysisStatus": (False,),
    "nlc.getLutStatus": (False,),
}


class IdsError(Exception):
    """A result with an error number."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def text(number: int) -> str:
    """Return what the instrument says about an error."""
    return f"EMULATOR: {_TEXTS.get(number, 'unknown error')}"


def blanks(method: str) -> tuple[object, ...]:
    """Return what stands for the values behind an error number.

    The maker's API reads the values of these methods whatever the number is; of all others it reads none.

    Args:
        method: full name.
    """
    return _BLANKS.get(method.removeprefix("com.attocube.").partition(".")[2], ())


def checked_axis(axis: int) -> int:
    """Return an axis that exists.

    Raises:
        IdsError: it does not.
    """
    if axis not in AXES:
        raise IdsError(OUT_OF_RANGE)
    return axis


def checked(value: int, lowest: int, highest: int) -> int:
    """Return a number within its range.

    Raises:
        IdsError: it is not.
    """
    if not lowest <= value <= highest:
        raise IdsError(OUT_OF_RANGE)
    return value
