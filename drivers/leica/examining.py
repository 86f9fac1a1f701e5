"""Who a Leica tracker is, and what `catseye doctor` says of it."""

from catseye.drivers.leica import codec
from catseye.drivers.leica.commands import (
    INITIALISED,
    LASER_READY,
    OK,
    SENSORS,
    TRACKER_READY,
    Command,
    laser_text,
)
from catseye.drivers.leica.settings import LeicaSettings
from catseye.drivers.leica.setup import Ask, reflectors, reply_to, require
from catseye.drivers.roles.device import Examination, Identity


async def identify(ask: Ask) -> Identity:
    """Return who answers; an older server knows neither its tracker's name nor its own version."""
    info = await reply_to(ask, Command.TRACKER_INFO)
    version = await reply_to(ask, Command.SOFTWARE_VERSION)
    status = await reply_to(ask, Command.SYSTEM_STATUS)
    *_, major, minor, build, _, _, serial = status.values("10i") if status.status == OK else (0,) * 10
    name, sensor = (codec.name_of(info.data[4:68]), info.values("i")[0]) if info.status == OK else ("", 0)
    model = name or SENSORS.get(int(sensor), "tracker with emScon")
    firmware = codec.name_of(version.data[:64]) if version.status == OK else ""
    simulated = "EMULATOR" in f"{name} {firmware}".upper()
    return Identity(f"Leica {model}", firmware or f"{major:g}.{minor:g}.{build:g}", f"{serial:g}", simulated)


async def examine(ask: Ask, where: str, settings: LeicaSettings) -> Examination:
    """Ask for the state of laser, distance meter and target, the face, the reflector and the air."""
    status = (await require(ask, where, Command.SYSTEM_STATUS)).values("8i")
    processor, laser, weather = int(status[1]), int(status[2]), int(status[7])
    locked = (await require(ask, where, Command.TRACKER_STATUS)).values("i")[0] == TRACKER_READY
    face = (await require(ask, where, Command.FACE)).values("i")[0]
    facts = (
        f"{laser_text(laser)}, {'initialised' if processor == INITIALISED else 'initialised before the first point'}",
        f"face {face:g}, {'locked on a target' if locked else 'no target in the beam'}",
        await _reflector(ask, where),
        await _air(ask, where),
    )
    advice = []
    if laser != LASER_READY:
        advice.append(f"{laser_text(laser)}: switch it on and let it warm up before measuring")
    if not weather and settings.air is None:
        advice.append(
            "no weather station: state temperature_c, pressure_hpa and humidity_percent in [tracker.settings]; "
            "1 °C is 1 µm in a metre"
        )
    return Examination(facts, tuple(advice))


async def _reflector(ask: Ask, where: str) -> str:
    chosen = (await require(ask, where, Command.REFLECTOR)).values("i")[0]
    for name, (number, offset_mm) in (await reflectors(ask, where)).items():
        if number == chosen:
            return f"reflector {name}, surface offset {offset_mm:.4f} mm"
    return f"reflector number {chosen:g}, which the tracker does not list"


async def _air(ask: Ask, where: str) -> str:
    temperature_c, pressure_hpa, humidity = (await require(ask, where, Command.ENVIRONMENT)).values("3d")
    _, distance_meter = (await require(ask, where, Command.REFRACTION)).values("2d")
    return (
        f"air {temperature_c:.2f} °C, {pressure_hpa:.2f} hPa, {humidity:.1f} %RH; refractive index of the distance "
        f"meter {distance_meter:.7f}"
    )
