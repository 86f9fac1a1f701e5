"""What the sections of the cell file have in common."""

from collections.abc import Sequence
from typing import Annotated, Final

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Range = Annotated[list[Finite], Field(min_length=2, max_length=2)]
Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_.+-]{1,40}$")]

RECORD: Final = {"record": True}
"""Context for reading the cell of a stored run: nothing is driven with it, so what it may drive is not judged."""


class Section(BaseModel):
    """A table of the cell file."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


def require_own_names(what: str, names: Sequence[str]) -> None:
    """Refuse two things of one name.

    Args:
        what: they are, in the plural, as the file calls them: `[[target]]`.

    Raises:
        ValueError: two have one name.
    """
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"two {what} are called {name}; give each a name of its own")
