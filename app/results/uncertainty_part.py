"""The part of a result file that says how its uncertainties were propagated and where they come from."""

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

Finite = Annotated[float, Field(allow_inf_nan=False)]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="ignore")


class CoverageInterval(_Part):
    """Limits that a parameter lies between with the stated coverage."""

    parameter: str
    unit: Literal["mm", "mdeg", "um"]
    value: Finite
    u: Finite
    low: Finite
    high: Finite
    degrees_of_freedom: Finite | None = None


class ValidationRow(_Part):
    """Interval of the Jacobian against that of the draws (JCGM 101)."""

    parameter: str
    unit: Literal["mm", "mdeg", "um"]
    difference: Finite
    delta: Finite
    sampling: Finite
    verdict: Literal["validated", "not validated", "too few draws"]


class MonteCarloPart(_Part):
    """How the draws were made, and whether they bear the Jacobian out."""

    draws: int
    seed: int
    damped_solutions: int
    validation: list[ValidationRow]


class ContributionRow(_Part):
    """What each contributor makes of one result."""

    result: str
    unit: Literal["um", "mdeg"]
    u: Finite
    u_parts: list[Finite]
    shares: list[Finite]


class ContributionTable(_Part):
    """All of them; the shares of a row sum to 1."""

    contributors: list[str]
    rows: list[ContributionRow]

    @model_validator(mode="after")
    def _one_part_a_contributor(self) -> Self:
        for row in self.rows:
            if not len(row.u_parts) == len(row.shares) == len(self.contributors):
                raise ValueError(
                    f"{row.result}: one part for each of {len(self.contributors)} contributors is needed"
                )
        return self


class CorrelationPair(_Part):
    """Two parameters of the arm that depend on one another."""

    parameters: tuple[str, str]
    coefficient: Finite


class UncertaintyPart(_Part):
    """How uncertainties were propagated and where they come from."""

    method: Literal["jacobian", "monte-carlo"]
    coverage: Finite
    intervals: list[CoverageInterval]
    contributions: ContributionTable
    correlations: list[CorrelationPair]
    monte_carlo: MonteCarloPart | None = None
