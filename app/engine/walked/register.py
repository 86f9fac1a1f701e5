"""The walks of a cell that still hold: nothing but the runs themselves says what was walked."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, Final

from catseye.app.cell.bodies import workspace_of
from catseye.app.cell.model import Cell
from catseye.app.cell.scara.sections import TIMES
from catseye.app.engine.walked.tube import Leg
from catseye.app.errors import StorageError
from catseye.app.store.catalog import paths_of
from catseye.app.store.reader import RunReader, StoredStep
from catseye.app.store.seal import read_manifest
from catseye.app.store.verify import verify
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.records import Json

WALK: Final = "walk"
"""Name of the procedure that a walk is stored as, and of what its record says about it."""

_NO_BODIES: Final = (
    "format",
    "interferometer",
    "environment",
    "air",
    "io",
    "material",
    "tracker",
    "ballbar",
    "angular_optics",
    "linear_optics",
    "device",
    "alignment",
    "conditions",
    "engine",
    "runs",
    "hooks",
    "measurement",
    "uncertainty",
    "plausibility",
    "workspace",
    "body",
)
"""Sections that say nothing about where anything stands, and those that the bodies made of them stand for.

A section that is not named here counts."""

_NO_GEOMETRY: Final = (
    "driver",
    "endpoint",
    "datalink_endpoint",
    "mxt_endpoint",
    "settings",
    "tool",
    "override_cap_percent",
    "override_cap_reason",
    "gear_orders",
    "z_zero_mm",
    "c_zero_deg",
    *TIMES,
    "follow_speed_deg_s",
    "follow_acceleration_deg_s2",
)
"""Keys of [robot] of which the same holds."""


def geometry_digest(cell: Cell) -> str:
    """Return the SHA-256 of everything that a walk depends on: arm, limits, bodies, reflectors.

    Bodies count as they are, from the arm's description or from the cell file, whether confirmed or not.
    """
    values = cell.model_dump(mode="json")
    robot = {key: value for key, value in values["robot"].items() if key not in _NO_GEOMETRY}
    bodies = asdict(replace(workspace_of(cell), unconfirmed=()))
    for joint in bodies["chain"]["joints"]:
        # An untilted joint counts as it did before tilts were described: older walks still hold.
        if not joint["beta_deg"]:
            del joint["beta_deg"]
    kept = {key: value for key, value in values.items() if key not in _NO_BODIES}
    kept |= {"robot": robot, "bodies": bodies}
    return hashlib.sha256(json.dumps(kept, sort_keys=True).encode()).hexdigest()


def walk_fact(procedure: str, cell: Cell) -> dict[str, Json]:
    """Return what the record of a walk says about it."""
    return {"procedure": procedure, "geometry_sha256": geometry_digest(cell)}


def walked_legs(root: Path, cell: Cell, arm: Identity) -> list[Leg]:
    """Return every motion of sealed, unchanged walks of this arm in this cell that was driven to its end."""
    digest, found = geometry_digest(cell), []
    for path in paths_of(root, WALK):
        try:
            if _holds(path, digest, arm, cell.robot.endpoint):
                found += own_legs(path)
        except StorageError:
            # A record that cannot be read shows nothing; at worst a motion is walked again.
            continue
    return found


def own_legs(path: Path) -> list[Leg]:
    """Return the motions of one walk that were driven to their end.

    Raises:
        StorageError: the run cannot be read.
    """
    return [_leg(step) for step in RunReader(path).steps()]


def as_row(leg: Leg) -> dict[str, Json]:
    """Return a motion as a step of a walk stores it."""
    return {"from": list(leg.start), "to": list(leg.end)}


def _leg(step: StoredStep) -> Leg:
    return Leg(_pose(step.result["from"]), _pose(step.result["to"]))


def _pose(stored: Any) -> Pose:
    return tuple(float(value) for value in stored)


def _holds(path: Path, digest: str, arm: Identity, endpoint: str) -> bool:
    meta = RunReader(path).meta
    walk: Any = meta.get(WALK) or {}
    same = walk.get("geometry_sha256") == digest and _is_arm(meta, arm, endpoint)
    return same and read_manifest(path) is not None and verify(path).ok


def _is_arm(meta: Mapping[str, Any], arm: Identity, endpoint: str) -> bool:
    stored = (meta.get("devices") or {}).get("robot") or {}
    compared = ("model", "serial", "simulated")
    if any(stored.get(name) != getattr(arm, name) for name in compared):
        return False
    # Controllers of one model that report no serial number are distinguished by their endpoints.
    return bool(arm.serial) or arm.simulated or _endpoint(meta) == endpoint


def _endpoint(meta: Mapping[str, Any]) -> Json:
    robot: Any = (meta.get("configuration") or {}).get("robot") or {}
    endpoint: Json = robot.get("endpoint")
    return endpoint
