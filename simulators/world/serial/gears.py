"""What gears add to links beside twist and play: periodic errors, a stated reversal, and what warmth does."""

from collections.abc import Sequence

import numpy as np

from catseye.simulators.world.serial.drivetrain import Drive
from catseye.simulators.world.serial.truth import JointTruth, column
from catseye.simulators.world.types import Floats


class Gears:
    """Errors of n joints.

    Args:
        truths: a joint each.
    """

    def __init__(self, truths: Sequence[JointTruth]) -> None:
        self._waves = [
            (number, wave.order, wave.cos_deg, wave.sin_deg)
            for number, truth in enumerate(truths)
            for wave in truth.waves
        ]
        self._friction_nm = np.maximum(column(truths, "link_friction_nm"), 1e-12)
        self._reversal_deg = column(truths, "reversal_deg")
        self._warming_deg = column(truths, "warming_deg")
        self._warming_s = column(truths, "warming_s")

    def errors_deg(self, drive: Drive, times_s: Floats) -> Floats:
        """Return what they add.

        A stated reversal passes from one side to the other as the friction behind the transmission does.

        Args:
            drive: at the bench times, shape (m, n).
            times_s: bench times, shape (m,).

        Returns:
            deg, shape (m, n).
        """
        side = np.clip(drive.friction_nm / self._friction_nm, -1.0, 1.0)
        warm = 1.0 - np.exp(-times_s[:, None] / self._warming_s)
        found: Floats = 0.5 * self._reversal_deg * side + self._warming_deg * warm
        for number, order, cosine, sine in self._waves:
            turn = np.deg2rad(order * drive.link_deg[:, number])
            found[:, number] += cosine * np.cos(turn) + sine * np.sin(turn)
        return found
