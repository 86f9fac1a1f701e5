"""What two measurements of one arm have in common: errors that are the same in both are none of their difference."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from catseye.app.results.scara.result import Result
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Contributor
from catseye.calibration.scara.identification import IdentifiedArm

_MM_PER_UM = 1e-3


@dataclass(frozen=True)
class SharedErrors:
    """Errors of both arms that come from the same sources.

    Attributes:
        names: of the contributors.
        taken_up: what each of them has moved the parameters of both arms by, mm and rad, a column a source.
        links_mm2: covariance of both estimates of a link by what is common to all distances (the laser's scale), by
            its name.
    """

    names: tuple[str, ...]
    taken_up: tuple[tuple[Floats, Floats], ...]
    links_mm2: Mapping[str, float]

    @classmethod
    def of(cls, results: tuple[Result, Result], arms: tuple[IdentifiedArm, IdentifiedArm]) -> Self:
        """Return what two results of one arm share: contributors that stand in both error budgets alike."""
        first, second = ({_stated(one): moved for one, moved in arm.taken_up.items()} for arm in arms)
        both = [one for one in first if one in second and first[one].shape[1] == second[one].shape[1]]
        common = _common_to_all(results)
        links = {
            link: sum(_um(results[0], link, name) * _um(results[1], link, name) for name in common)
            * _MM_PER_UM**2
            for link in ("L1", "L2")
        }
        named = [name for name in common if any(_um(results[0], link, name) for link in ("L1", "L2"))]
        return cls(
            (*(one.name for one in both), *named), tuple((first[one], second[one]) for one in both), links
        )

    def covariance(self, first: Floats, second: Floats) -> Floats:
        """Return the covariance of linear functions of both arms' parameters.

        Args:
            first: what each parameter of the first arm contributes, shape (…, p).
            second: likewise of the second arm, shape (…, q).
        """
        found = np.zeros(first.shape[:-1])
        for one, other in self.taken_up:
            found += np.sum((first @ one) * (second @ other), axis=-1)
        return found


NOTHING_SHARED = SharedErrors((), (), {})


def _stated(contributor: Contributor) -> Contributor:
    """Return a contributor as it was stated: what distances have shown of it is each measurement's own affair."""
    return replace(contributor, spectrum=())


def _common_to_all(results: tuple[Result, Result]) -> list[str]:
    """Return the names of contributors of one error for all distances that stand in both budgets alike."""
    stated = [
        {} if result.budget is None else {entry.name: entry for entry in result.budget.contributor}
        for result in results
    ]
    return [
        name
        for name, entry in stated[0].items()
        if entry.correlation == "common" and stated[1].get(name) == entry
    ]


def _um(result: Result, link: str, contributor: str) -> float:
    """Return what a contributor makes of u of a link, µm."""
    if result.uncertainty is None:
        return 0.0
    table = result.uncertainty.contributions
    row = next((row for row in table.rows if row.result == link), None)
    if row is None or contributor not in table.contributors:
        return 0.0
    return row.u_parts[table.contributors.index(contributor)]
