"""Protocols by name: what each emulated endpoint speaks."""

from collections.abc import Callable

from catseye.simulators.attocube.device import Ids, IdsOptions
from catseye.simulators.attocube.json_rpc import IdsSession
from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import World
from catseye.simulators.counter.line_protocol import CounterSession
from catseye.simulators.errors import EmulatorError
from catseye.simulators.heidenhain.nd import Display, NdSession
from catseye.simulators.lasertex.hpi import Hpi, HpiSession
from catseye.simulators.melfa.choices import Choices
from catseye.simulators.melfa.datalink import NUMBER_FORMATS, Datalink, DatalinkSession
from catseye.simulators.melfa.mxt import MODES, Mxt, MxtOptions, MxtSession
from catseye.simulators.melfa.r_protocol import MelfaSession
from catseye.simulators.modbus.emulators import air_registers, io_block, modbus_sessions
from catseye.simulators.options import LengthOptions, choice, flag, number, whole
from catseye.simulators.ports.session import Session
from catseye.simulators.umd.display import Umd, UmdOptions, UmdSession
from catseye.simulators.vaisala.ptu300 import Ptu300, Ptu300Session

Note = Callable[[str], None]
"""Is told each request of a client."""

NewSession = Callable[[], Session]
"""Makes the session of a new client."""

Maker = Callable[[World, EmulatedDevice, Note], NewSession]
"""Makes one device's endpoint; what all its clients share is made here, once."""


def _melfa_r3(world: World, device: EmulatedDevice, note: Note) -> NewSession:
    if device.options:
        world.controller.choices = Choices.of(device)
    if device.endpoint.startswith("serial:"):
        # On RS-232 requests have a terminator, and answers end with CR (sheet `melfa`, section 1.2).
        return lambda: MelfaSession(world.controller, "\r", note, segments=False)
    return lambda: MelfaSession(world.controller, world.config.answer_suffix, note)


def _attocube_ids(world: World, device: EmulatedDevice, note: Note) -> NewSession:
    options = IdsOptions(
        dialect=choice(device, "dialect", ("ids", "sen")),
        axis=whole(device, "axis", 0, 0, 2),
        sign=LengthOptions.of(device).sign,
        bare_mode=flag(device, "bare_mode"),
        start_time_s=number(device, "start_time_s", 3.0),
        ecu_enabled=flag(device, "ecu_enabled"),
    )
    ids = Ids(world.instrument(device.name), world.probe, options)
    return lambda: IdsSession(ids, note)


def _melfa_datalink(world: World, device: EmulatedDevice, note: Note) -> NewSession:
    name = _program_name(device, "CATSDL")
    program = Datalink(world.controller, name, choice(device, "number_format", NUMBER_FORMATS))
    world.controller.install(program)
    return lambda: DatalinkSession(program, note)


def _program_name(device: EmulatedDevice, default: str) -> str:
    name = device.options.get("program") or default
    if not isinstance(name, str) or not name.isalnum() or not name.isascii():
        raise EmulatorError(f"{device.name}: option program has to be letters and digits, not {name!r}")
    return name.upper()


def _melfa_mxt(world: World, device: EmulatedDevice, note: Note) -> NewSession:
    options = MxtOptions(
        program=_program_name(device, "CATSMXT"),
        mode=choice(device, "mxt_mode", MODES),
        cycle_s=number(device, "mxt_cycle_ms", 7.1) / 1e3,
        filter_s=number(device, "mxt_filter_ms", 10.0) / 1e3,
        timeout_s=number(device, "mxt_timeout_s", 0.5),
        lag_s=number(device, "mxt_lag_ms", 8.0) / 1e3,
        lag_spread_s=number(device, "mxt_lag_spread_ms", 0.2) / 1e3,
    )
    if not 1e-3 <= options.cycle_s <= 0.1 or not 0.0 <= options.filter_s <= 1.0:
        raise EmulatorError(f"{device.name}: mxt_cycle_ms has to be 1 to 100 ms, mxt_filter_ms 0 to 1000 ms")
    program = Mxt(world.controller, options, world.keeper.sync)
    world.controller.install(program)
    world.controller.parameters.preset("MXTTOUT", [str(options.timeout_cycles)])
    return lambda: MxtSession(program, note)


def _heidenhain_nd(world: World, device: EmulatedDevice, note: Note) -> NewSession:
    decimals = whole(device, "decimals", 4, 0, 7)
    display = Display(world.instrument(device.name), LengthOptions.of(device), decimals)
    return lambda: NdSession(display, note)


def _line_counter(world: World, device: EmulatedDevice, note: Note) -> NewSession:
    instrument = world.instrument(device.name)
    corrected = choice(device, "compensated", ("instrument", "none")) == "instrument"
    lengths = LengthOptions(compensated=corrected)
    return lambda: CounterSession(instrument, note, lengths)


def _lasertex_hpi(world: World, device: EmulatedDevice, note: Note) -> NewSession:
    full_scale = whole(device, "signal_full_scale", 100, 1, 255)
    hpi = Hpi(world.instrument(device.name), world.probe, LengthOptions.of(device), full_scale)
    return lambda: HpiSession(hpi, note)


def _umd(world: World, device: EmulatedDevice, note: Note) -> NewSession:
    del note
    options = UmdOptions(
        rate_hz=number(device, "rate_hz", 610.35),
        wavelength_nm=number(device, "vacuum_wavelength_nm", 632.9908),
        multiplier=int(number(device, "multiplier", 1)),
        sign=LengthOptions.of(device).sign,
        axes=int(number(device, "axes", 1)),
    )
    if options.rate_hz <= 0 or options.multiplier not in {1, 2, 4} or options.axes not in {1, 3}:
        raise EmulatorError(f"{device.name}: rate_hz has to be above 0, multiplier 1, 2 or 4, axes 1 or 3")
    umd = Umd(world.instrument(device.name), world.probe, world.keeper, options)
    return lambda: UmdSession(umd)


def _modbus_air(world: World, device: EmulatedDevice, note: Note) -> NewSession:
    return modbus_sessions(air_registers(world.probe, device), device, note)


def _modbus_io(world: World, device: EmulatedDevice, note: Note) -> NewSession:
    block = world.blocks.setdefault(device.name, io_block(world.door, device))
    return modbus_sessions(block, device, note)


def _vaisala_ascii(world: World, device: EmulatedDevice, note: Note) -> NewSession:
    address = int(number(device, "address", 0))
    sensor = Ptu300(world.probe, world.bench, address=address)
    return lambda: Ptu300Session(sensor, note)


PROTOCOLS: dict[str, Maker] = {
    "attocube-ids": _attocube_ids,
    "heidenhain-nd": _heidenhain_nd,
    "melfa-r3": _melfa_r3,
    "melfa-datalink": _melfa_datalink,
    "melfa-mxt": _melfa_mxt,
    "line-counter": _line_counter,
    "lasertex-hpi": _lasertex_hpi,
    "modbus-air": _modbus_air,
    "umd": _umd,
    "modbus-io": _modbus_io,
    "vaisala-ascii": _vaisala_ascii,
}


def session_maker(world: World, device: EmulatedDevice, note: Note) -> NewSession:
    """Return what makes the sessions of a device's endpoint.

    Args:
        world: the emulated bench.
        device: which endpoint.
        note: is told each request.

    Raises:
        EmulatorError: there is no such protocol, or an option is wrong.
    """
    maker = PROTOCOLS.get(device.protocol)
    if maker is None:
        raise EmulatorError(
            f"{device.name}: there is no emulator of {device.protocol!r}; there are {', '.join(sorted(PROTOCOLS))}"
        )
    return maker(world, device, note)
