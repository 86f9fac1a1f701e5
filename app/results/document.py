"""What a command writes with `--json`: built in one place, and read back by the terminal UI with the same class."""

import math
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict


class Document(BaseModel):
    """A result as plain values, or a part of one."""

    model_config = ConfigDict(frozen=True, from_attributes=True)

    def json_object(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        return self.model_dump(mode="json")


def _or_none(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


Stated = Annotated[float | None, BeforeValidator(_or_none)]
"""A number; null where there is none, which is NaN or infinity inside."""
