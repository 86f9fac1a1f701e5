"""Tables and a tool of the emulated day: what the true arm of the tests shows of its nests."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from catseye.app import cell
from catseye.calibration.core.types import Floats
from tests.unit.calibration.serial_arm.nominal import NOISE_MM
from tests.unit.calibration.serial_arm.true_arm import MASSES, NESTS, TrueArm, random_poses

_JOINTS = ",".join(f"q{k}_deg" for k in range(1, 7))


def arm_file(folder: Path) -> Path:
    """Write the IRB 120 with the link masses of Table IV of the paper."""
    shipped = (Path(cell.__file__).parent / "arms" / "irb120.toml").read_text("utf-8")
    head, _, rest = shipped.partition("[[link]]")
    bodies = rest[rest.index("\n[[body]]") :]
    links = "".join(
        f'[[link]]\njoint = "J{frame}"\nmass_kg = {mass}\ncentre_mm = {list(centre)}\n\n'
        for frame, mass, centre in MASSES[:-1]
    )
    path = folder / "arm.toml"
    path.write_text(head + links + bodies, encoding="utf-8")
    return path


def tool_file(folder: Path, names: Sequence[str] = ("nest1", "nest2", "nest3")) -> Path:
    """Write the triangular artifact."""
    _, mass, centre = MASSES[-1]
    targets = "".join(
        f'[[target]]\nname = "{name}"\nx_mm = {x}\ny_mm = {y}\nz_mm = {z}\n'
        for name, (x, y, z) in zip(names, NESTS.tolist(), strict=True)
    )
    path = folder / "plate.toml"
    head = f'format = "catseye-tool/1"\nname = "plate"\nmass_kg = {mass}\ncentre_mm = {list(centre)}\n'
    path.write_text(head + targets, encoding="utf-8")
    return path


def poses_file(
    folder: Path,
    poses_deg: Floats,
    seed: int | None = 1,
    u_mm: str = f"{NOISE_MM}",
    true: TrueArm | None = None,
) -> Path:
    """Write places of one nest a pose, in turn."""
    nest = np.arange(len(poses_deg)) % 3
    places = (true or TrueArm()).nests(poses_deg, nest)
    if seed is not None:
        places = places + NOISE_MM * np.random.default_rng(seed).standard_normal(places.shape)
    lines = [f"pose,{_JOINTS},target,x_mm,y_mm,z_mm" + (",u_mm" if u_mm else "")]
    for k, (q, place) in enumerate(zip(poses_deg.tolist(), places.tolist(), strict=True)):
        cells = [f"pose {k + 1}", *map(repr, q), f"nest{nest[k] + 1}", *map(repr, place)]
        lines.append(",".join([*cells, u_mm] if u_mm else cells))
    path = folder / f"poses{len(poses_deg)}.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def some_poses(count: int = 45, seed: int = 1) -> Floats:
    return random_poses(count, seed)
