"""The part of a result file that says how its uncertainties were propagated and where they come from."""

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from catseye.app.files.column_rules import LARGEST_NUMBER

Finite = Annotated[float, Field(ge=-LARGEST_NUMBER, le=LARGEST_NUMBER, allow_inf_nan=False)]
Uncertainty = Annotated[float, Field(ge=0.0, le=LARGEST_NUMBER, allow_inf_nan=False)]
Method = Literal["jacobian", "monte-carlo"]
ParameterUnit = Literal["mm", "mdeg", "um"]
ContributionUnit = Literal["um", "mdeg"]


class ResultPart(BaseModel):
    """Part of a result file; keys beyond version 1 are passed over, for results travel between versions."""

    model_config = ConfigDict(frozen=True, extra="ignore", from_attributes=True)


class ResultColumns(ResultPart):
    """Columns of a table, equally long."""

    @model_validator(mode="after")
    def _equally_long(self) -> Self:
        lengths = {name: len(getattr(self, name)) for name in type(self).model_fields}
        if len(set(lengths.values())) > 1:
            raise ValueError(f"the columns differ in length: {lengths}")
        return self


class CoverageInterval(ResultPart):
    """Limits that a parameter lies between with the stated coverage."""

    parameter: str
    unit: ParameterUnit
    value: Finite
    u: Finite
    low: Finite
    high: Finite
    degrees_of_freedom: Finite | None = None


class ValidationRow(ResultPart):
    """Interval of the Jacobian against that of the draws (JCGM 101)."""

    parameter: str
    unit: ParameterUnit
    difference: Finite
    delta: Finite
    sampling: Finite
    verdict: Literal["validated", "not validated", "too few draws"]


class MonteCarloPart(ResultPart):
    """How the draws were made, and whether they bear the Jacobian out."""

    draws: int
    seed: int
    damped_solutions: int
    validation: list[ValidationRow]


class ContributionRow(ResultPart):
    """What each contributor makes of one result."""

    result: str
    unit: ContributionUnit
    u: Finite
    u_parts: list[Finite]
    shares: list[Finite]


class ContributionTable(ResultPart):
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


class CorrelationPair(ResultPart):
    """Two parameters of the arm that depend on one another."""

    parameters: tuple[str, str]
    coefficient: Finite


class UncertaintyPart(ResultPart):
    """How uncertainties were propagated and where they come from."""

    method: Method
    coverage: Finite
    intervals: list[CoverageInterval]
    contributions: ContributionTable
    correlations: list[CorrelationPair]
    monte_carlo: MonteCarloPart | None = None
