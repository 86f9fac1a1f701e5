"""How an arm stands, of its description and of its joints."""

import math

import numpy as np

from catseye.app.protocol.posture import Limb, Place, Posture
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.bench import Workspace


def posture_of(workspace: Workspace, joints: Pose | None) -> Posture | None:
    """Return how the arm stands; None while its joints are not known.

    Args:
        workspace: with the arm's joints and bodies.
        joints: as reported, deg or mm.
    """
    if joints is None or not all(map(math.isfinite, joints)):
        return None
    frames = workspace.chain.frames(np.array([joints]))[:, 0]

    def place(frame: int, point_mm: Place) -> Place:
        x_mm, y_mm, z_mm = (frames[frame] @ (*point_mm, 1.0))[:3].tolist()
        return x_mm, y_mm, z_mm

    # Behind the first joint lies the plane in which links with parallel axes move.
    forward_x, forward_y = frames[1][:2, 0].tolist()
    return Posture(
        joints_mm=tuple(place(frame, (0.0, 0.0, 0.0)) for frame in range(len(frames))),
        heading_deg=math.degrees(math.atan2(forward_y, forward_x)),
        limbs=tuple(
            Limb(
                name=body.name,
                start_mm=place(body.frame, body.start_mm),
                end_mm=place(body.frame, body.end_mm),
                radius_mm=body.radius_mm,
            )
            for body in workspace.bodies
        ),
        table_z_mm=workspace.table_z_mm,
    )
