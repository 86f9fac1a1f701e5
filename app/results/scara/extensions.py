"""What --extend names, as terms beyond the model."""

import re
from collections.abc import Sequence

from catseye.app.errors import UsageError
from catseye.calibration.scara.extension import Term, crosstalk, j4_map, periodic, thermal_drift

_PERIODIC = re.compile(r"periodic([12]):([0-9]{1,4})")
_HIGHEST_ORDER = 2000


def parse_extensions(texts: Sequence[str]) -> tuple[Term, ...]:
    """Return the terms that words like crosstalk, j4, thermal, periodic1:36 stand for; each term once.

    Raises:
        UsageError: a word is unknown or an order is out of range.
    """
    terms = [term for text in texts for term in _terms(text)]
    return tuple(dict.fromkeys(terms))


def _terms(text: str) -> tuple[Term, ...]:
    match text:
        case "crosstalk":
            return crosstalk()
        case "j4":
            return j4_map()
        case "thermal":
            return thermal_drift()
    found = _PERIODIC.fullmatch(text)
    if found is None:
        raise UsageError(
            f"--extend {text}: unknown; possible are crosstalk, j4, thermal, and periodic1:ORDER or periodic2:ORDER "
            "with the number of periods in a turn of the joint, for example periodic1:36"
        )
    order = int(found[2])
    if not 1 <= order <= _HIGHEST_ORDER:
        raise UsageError(
            f"--extend {text}: the order has to be 1 to {_HIGHEST_ORDER} periods in a turn of the joint"
        )
    return periodic(1 if found[1] == "1" else 2, (order,))
