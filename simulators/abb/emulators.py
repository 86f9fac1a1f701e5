"""The controller's endpoint: Robot Web Services 1.0."""

from pydantic import Field

from catseye.simulators.abb.controller import AbbController
from catseye.simulators.abb.server import RwsSession, Server
from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import DeviceOptions, Emulator, NewSession, Note
from catseye.simulators.errors import EmulatorError

_SEEDS_APART = 1_000_003


class AbbRws(Emulator):
    """Robot Web Services of an IRC5 over HTTP."""

    role = "robot"
    arm = "serial"

    class Options(DeviceOptions):
        """Options.

        Attributes:
            password: of the user Default User.
            sessions: as many clients may be logged in.
            requests: of one connection, which ends behind them; 0: any number.
            strict_counts: no count of a nonce is taken twice.
            explicit_mastership: nothing is changed without mastership; otherwise one that nobody holds is taken for
                the moment.
            life_s: of a nonce and of a silent session, real s; an assumption.
        """

        password: str = "robotics"  # the factory's
        sessions: int = Field(default=70, ge=1, le=1000)
        requests: int = Field(default=400, ge=0)
        strict_counts: bool = False
        explicit_mastership: bool = False
        life_s: float = Field(default=300.0, gt=0.0)

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make what all clients share."""
        options = cls.Options.of(device)
        controller = context.controller
        if not isinstance(controller, AbbController):
            raise EmulatorError(f"{device.name}: the robot of this bench has no IRC5")
        server = Server(
            controller,
            # Nobody gets the nonces and sessions of before a start again.
            context.config.seed + _SEEDS_APART * controller.starts,
            password=options.password,
            most_sessions=options.sessions,
            most_requests=options.requests,
            strict_counts=options.strict_counts,
            explicit_mastership=options.explicit_mastership,
            life_s=options.life_s,
        )
        return lambda: RwsSession(server, note)
