"""The controller's endpoint: the proxy of its variables."""

from pydantic import Field

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import DeviceOptions, Emulator, NewSession, Note
from catseye.simulators.errors import EmulatorError
from catseye.simulators.kuka.controller import KukaController
from catseye.simulators.kuka.frames import LONGEST_BYTES
from catseye.simulators.kuka.panel import PanelOptions
from catseye.simulators.kuka.varproxy import Proxy, VarproxySession


class KukaVarproxy(Emulator):
    """KUKAVARPROXY or C3 Bridge over TCP."""

    role = "robot"
    arm = "serial"

    class Options(DeviceOptions):
        """Options.

        Attributes:
            old_proxy: a KUKAVARPROXY of old, which knows single ASCII variables only and closes idle connections.
            old_proxy_loses: what comes to one while it carries out a request is lost.
            longest_reply_bytes: of the rest of a reply.
            limit_needs_confirm: a point beyond the software limits is a message that has to be confirmed; else it
                goes when the program is reset.
            bco_halts: behind block coincidence the program halts in T1, T2 and AUT until start is pressed again.
            jog_deg: how far one press of a jog key turns an axis.
        """

        old_proxy: bool = False
        old_proxy_loses: bool = False
        longest_reply_bytes: int = Field(default=LONGEST_BYTES, ge=64, le=LONGEST_BYTES)
        limit_needs_confirm: bool = True
        bco_halts: bool = True
        jog_deg: float = Field(default=1.0, gt=0.0, le=10.0)

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make what all clients of the proxy share."""
        options = cls.Options.of(device)
        controller = context.controller
        if not isinstance(controller, KukaController):
            raise EmulatorError(f"{device.name}: the robot of this bench has no KUKA controller")
        if options.old_proxy_loses and not options.old_proxy:
            raise EmulatorError(
                f"{device.name}: old_proxy_loses is of an old proxy: set old_proxy = true, too"
            )
        controller.panel.options = PanelOptions(
            options.limit_needs_confirm, options.bco_halts, options.jog_deg
        )
        proxy = Proxy(
            context.bench,
            controller.variables,
            context.config.seed,
            longest_bytes=options.longest_reply_bytes,
            old=options.old_proxy,
            loses=options.old_proxy_loses,
        )
        return lambda: VarproxySession(proxy, note)
