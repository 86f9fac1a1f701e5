"""Joints of poses, and what is said of the poses that an arm does not reach."""

from dataclasses import dataclass

from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.types import Floats

_NAMED = 5


@dataclass(frozen=True)
class Named:
    """A row and what there is to say of it."""

    row: int
    reason: str


@dataclass(frozen=True)
class Inverse:
    """Joints of poses.

    Attributes:
        poses: deg or mm, NaN in the rows that `refused` names, shape (n, joints).
        refused: rows that the arm does not reach within its ranges, in their order.
        singular: rows that it reaches where a joint is free or two solutions meet, in their order.
    """

    poses: Floats
    refused: tuple[Named, ...]
    singular: tuple[Named, ...]

    def required(self) -> Floats:
        """Return the joints of all rows, deg or mm, shape (n, joints).

        Raises:
            KinematicsError: there are rows that the arm does not reach.
        """
        if self.refused:
            listed = "; ".join(f"row {one.row}: {one.reason}" for one in self.refused[:_NAMED])
            more = f"; and {len(self.refused) - _NAMED} more" if len(self.refused) > _NAMED else ""
            raise KinematicsError(
                f"{len(self.refused)} of {len(self.poses)} poses are not reached: {listed}{more}"
            )
        return self.poses
