"""Pictures of a measurement with open-loop tracking, under way or done."""

from catseye.app.results.figures import Figure
from catseye.app.results.model import Section, section
from catseye.app.results.scara.figures.commands import command_figure, top_view_figure
from catseye.app.results.scara.figures.maps_so_far import growing_map_figure
from catseye.app.results.scara.found.commands import MeasurementSoFar, Progress, measures_commands
from catseye.app.store.reader import RunReader


def measuring_section(reader: RunReader) -> Section:
    """Return what became of every command, reflector by reflector; nothing of another run."""
    if not measures_commands(reader):
        return section("commands", "Commands", [])
    so_far = Progress(reader).look(reader)
    figures = [command_figure(so_far, so_far.parts), growing_map_figure(so_far)]
    return section("commands", "Commands", figures)


def measuring_figures(so_far: MeasurementSoFar) -> tuple[Figure, ...]:
    """Return what is looked at while measuring: the reflector under way, the maps, then all reflectors."""
    whole = command_figure(so_far, so_far.parts) if len(so_far.parts) > 1 else None
    figures = (
        command_figure(so_far, [so_far.now]),
        growing_map_figure(so_far),
        top_view_figure(so_far, so_far.now),
        whole,
    )
    return tuple(one for one in figures if one is not None)
