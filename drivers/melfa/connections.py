"""The connections to one controller: for motion, for STOP, for questions while the arm moves."""

from collections.abc import Sequence

from catseye.drivers.melfa.session import Session
from catseye.drivers.melfa.side import QUESTIONS, Side
from catseye.drivers.roles.errors import LinkError


class Connections:
    """Up to three sessions with one controller.

    Args:
        main: holds the operation right and waits for the end of motions.
        stop: for STOP, which must not queue behind that wait; None: there is but one.
        status: for questions while the arm moves, so that they do not stand before a STOP; None: `stop` serves them,
            as it does while this one is lost.

    Attributes:
        side: asks questions while the arm moves.
    """

    def __init__(self, main: Session, stop: Session | None, status: Session | None) -> None:
        self.main = main
        self.side = Side(main)
        self._further = (("STOP", stop), (QUESTIONS, status))
        self._open: list[Session] = []
        self._note = ""

    @property
    def note(self) -> str:
        """What an operator should know of connections that are missing; empty when all are there."""
        return self._note or self.side.note

    @property
    def has_side(self) -> bool:
        """Whether there is one that no motion blocks."""
        return bool(self._open)

    @property
    def askers(self) -> Sequence[Session]:
        """Those on which a question is answered while the arm moves."""
        return tuple(reversed(self._open)) or (self.main,)

    @property
    def all(self) -> Sequence[Session]:
        """All that may be open; the one that a motion waits on comes first."""
        return (self.main, *self._open)

    @property
    def every(self) -> Sequence[Session]:
        """All, whether open or not."""
        return (self.main, *(session for _, session in self._further if session is not None))

    async def open_further(self) -> None:
        """Open those beside the first; a controller that refuses them leaves a note.

        Raises:
            WrongDeviceError: something else answers there.
        """
        await self.shut()
        self._note = ""
        if self._further[0][1] is None:
            self._note = "no second connection for STOP on this line: it goes between two polls"
        for use, session in self._further:
            if session is None:
                break
            try:
                await session.open()
            except LinkError as exc:
                self._note = self._missing(use, exc)
                break
            self._open.append(session)
        self.side = Side(*self.askers)

    async def shut(self) -> None:
        """Close those beside the first at once."""
        await self.side.close()
        further, self._open = self._open, []
        for session in further:
            await session.close()

    def _missing(self, use: str, cause: LinkError) -> str:
        if not self._open:
            return (
                f"no second connection for {use}: motions are polled and STOP goes between two polls; give "
                f"stop_endpoint another port of the controller ({cause})"
            )
        return (
            f"no third connection for {use}: the stop connection serves them; give status_endpoint another port of "
            f"the controller ({cause})"
        )
