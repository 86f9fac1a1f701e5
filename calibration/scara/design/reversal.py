"""A measurement made twice, the second time with the interferometer turned by half a turn on J4's flange or not."""

from dataclasses import replace

import numpy as np

from catseye.calibration.scara.design.sight import Sight
from catseye.calibration.scara.design.study import Study


def measured_twice(study: Study, *, turned: bool) -> Study:
    """Return a study of all commands twice.

    Args:
        turned: the interferometer is mounted turned by half a turn the second time.
    """
    count = len(study.commands)
    mount = np.repeat([0.0, np.pi if turned else 0.0], count)
    return replace(study, commands=study.commands.select(np.tile(np.arange(count), 2)), mount_rad=mount)


def seen_twice(sight: Sight) -> Sight:
    """Return how a measurement sees a reflector when it is made twice, each time with segments of its own."""
    again = np.where(sight.segment >= 0, sight.segment + sight.segments, -1)
    return replace(
        sight,
        seen=np.tile(sight.seen, 2),
        segment=np.concatenate([sight.segment, again]),
        breaks=2 * sight.breaks,
    )
