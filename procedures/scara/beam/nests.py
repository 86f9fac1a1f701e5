"""One cat's eye for several nests: it is carried from one to the next."""

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import NotPlacedError
from catseye.procedures.kit.tasks import PlaceReflector
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.questions import PLACE


class Nests:
    """Asks for the cat's eye where it is needed; nothing is asked where every nest has its own.

    Args:
        bench: says whether one reflector serves all.
    """

    def __init__(self, ctx: Context, bench: ScaraBench) -> None:
        self._ctx = ctx
        self._carried = bench.optics.one_reflector
        self._place: str | None = None

    async def place(self, reflector: Reflector, number: int = 1, target: Pose | None = None) -> None:
        """Have the cat's eye put into a reflector's nest unless this process knows it to be there.

        Args:
            number: how many times the plan has come to this nest, from 1; part of the question's id.
            target: where the arm goes then, which the question shows.

        Raises:
            NotPlacedError: the operator will not.
        """
        if not self._carried or self._place == reflector.name:
            return
        answer = await self._ctx.ask(
            PLACE.prompt(
                f"place/{reflector.name}" + (f"/{number}" if number > 1 else ""),
                f"Put the reflector into nest {reflector.name} at ({reflector.x_mm:g}, {reflector.y_mm:g}) mm, "
                "facing the robot, step back, then confirm.",
                task=PlaceReflector(reflector=reflector.name),
                target=target,
            )
        )
        if answer != "yes":
            raise NotPlacedError(
                f"the reflector was not put into nest {reflector.name}: start again when it can be"
            )
        self._place = reflector.name
