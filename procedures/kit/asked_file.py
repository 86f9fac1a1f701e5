"""A file that the operator names, asked for again until it can be used."""

from collections.abc import Callable
from dataclasses import replace
from typing import Final, TypeVar

from catseye.procedures.kit.columns import Columns, TableRule
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import TableFileError
from catseye.procedures.kit.mapping import TableMapping

Found = TypeVar("Found")

_MOST_FILES: Final = 10
"""After so many files that cannot be used nobody will find the right one."""


async def asked_file(
    ctx: Context,
    prompt: Prompt,
    table: TableRule | TableMapping,
    rehearsed: Columns,
    use: Callable[[str, Columns], Found],
) -> tuple[str, Found]:
    """Ask for a file until it can be used; return its name and what was found in it.

    Args:
        prompt: of the first attempt; the later ones begin with what is wrong.
        table: what its header may hold, or how a file of another program is read.
        rehearsed: what a rehearsal, which has no file, goes on with.
        use: finds what is wanted in the columns of the file of this name; raises TableFileError where it cannot.

    Raises:
        TableFileError: too many files could not be used.
    """
    complaint = ""
    for attempt in range(1, _MOST_FILES + 1):
        file = await ctx.ask(prompt if attempt == 1 else _again(prompt, attempt, complaint))
        try:
            return file, use(file, await ctx.read_table(file, table, rehearsed))
        except TableFileError as error:
            complaint = str(error)
            await ctx.warn(complaint)
    raise TableFileError(
        f"{complaint}; {_MOST_FILES} files could not be used: what was driven stays stored, so continue with catseye "
        "resume when the file is right"
    )


def _again(prompt: Prompt, attempt: int, complaint: str) -> Prompt:
    return replace(prompt, id=f"{prompt.id}/{attempt}", text=f"{complaint}. {prompt.text}")
