"""Leica laser tracker behind an emScon server, TCP 700 (sheet `trackers_ballbar`, section 1)."""

from pydantic import Field

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import DeviceOptions, Emulator, NewSession, Note
from catseye.simulators.leica.information import Information
from catseye.simulators.leica.instrument import Instrument
from catseye.simulators.leica.parameters import Parameters
from catseye.simulators.leica.server import Server
from catseye.simulators.leica.session import EmsconSession


class LeicaEmscon(Emulator):
    """A server with its tracker, which all clients share; it looks at whatever arm stands there."""

    role = "tracker"
    arm = "serial"

    class Options(DeviceOptions):
        """Options.

        Attributes:
            initialised: it was initialised before, by another program.
            warm_up_s: bench time from which the laser is ready.
            warm_again_s: how long the laser warms when its power comes back; an assumption.
            has_weather: there is a weather station.
            has_nivel: there is an inclination sensor.
        """

        initialised: bool = False
        warm_up_s: float = Field(default=0.0, ge=0.0, le=86_400.0)
        warm_again_s: float = Field(default=300.0, ge=0.0, le=86_400.0)
        has_weather: bool = True
        has_nivel: bool = True

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make the server that all clients share."""
        options = cls.Options.of(device)
        kept = Parameters()
        instrument = Instrument(
            context.bench,
            context.laser_tracker,
            context.air.of(device.name),
            kept,
            has_weather=options.has_weather,
        )
        began_with_power = device.name not in context.power_back_s
        if options.initialised and began_with_power:
            instrument.initialised = True
            instrument.go_home()
        information = Information(
            lambda: instrument.units, has_nivel=options.has_nivel, has_weather=options.has_weather
        )

        def warm_s() -> float:
            if began_with_power:
                return options.warm_up_s
            return context.power_back_s[device.name] + options.warm_again_s

        server = Server(instrument, kept, information, warm_s=warm_s, has_nivel=options.has_nivel)
        return lambda: EmsconSession(server, note, has_nivel=options.has_nivel)
