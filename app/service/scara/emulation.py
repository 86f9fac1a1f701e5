"""The emulated bench of a SCARA's cell file."""

from pathlib import Path

from catseye.app.cell.axes import arm_of
from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.model import Cell
from catseye.app.cell.scara.sections import Alignment
from catseye.app.files.documents import read_document
from catseye.app.service.emulation import control_endpoint, emulated_devices
from catseye.simulators.config import EmulationConfig, ReflectorPlace, Scara, Screws, TruthText


def emulation_config(cell: Cell, speed: float, seed: int, truth: Path | None) -> EmulationConfig:
    """Return the emulated bench of a cell file.

    Args:
        cell: what stands on the bench, and where its devices answer.
        speed: bench seconds in one real second.
        seed: of everything random.
        truth: result JSON with the true arm; None draws one.

    Raises:
        ConfigError: an endpoint cannot be emulated, or the file with the true arm cannot be read.
    """
    bench = scara_bench_of(cell, "the emulated bench")
    # The cell file narrows the height to where everything is measured; the emulated arm has its whole stroke.
    one, two, height, four = (axis.range for axis in arm_of(cell.robot).axes)
    return EmulationConfig(
        reflectors=tuple(ReflectorPlace(r.name, r.x_mm, r.y_mm, r.facing_deg) for r in cell.reflector),
        scara=Scara(bench.link1_mm, bench.link2_mm),
        limits=(one, two, height, four),
        start_joints=(0.0, 0.0, bench.j3_mm, 0.0),
        acceptance_mm=cell.optics.acceptance_mm,
        field_half_angle_deg=cell.optics.field_half_angle_deg,
        column_radius_mm=cell.optics.column_radius_mm,
        screws=_screws(cell.alignment),
        one_reflector=cell.optics.one_reflector,
        devices=emulated_devices(cell),
        control=control_endpoint(cell),
        speed=speed,
        seed=seed,
        truth=None if truth is None else TruthText(read_document(truth), str(truth)),
    )


def _screws(alignment: Alignment) -> Screws:
    return Screws(
        stage_mm_per_turn=alignment.stage_mm_per_turn * (1.0 if alignment.stage_clockwise == "+y" else -1.0),
        level_mrad_per_turn=alignment.level_mrad_per_turn
        * (1.0 if alignment.level_clockwise == "up" else -1.0),
    )
