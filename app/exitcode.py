"""Exit codes of the process."""

from enum import IntEnum


class ExitCode(IntEnum):
    """Exit codes of every command; scripts rely on them."""

    DONE = 0
    """Everything asked for has been done."""

    REJECTED = 1
    """The measurement was rejected, or a criterion failed."""

    USAGE = 2
    """The command line, the cell file or another input file is wrong."""

    DEVICE = 3
    """A device or its link failed."""

    TIMEOUT = 4
    """Something was not over in time, or a prompt stayed unanswered."""

    SAFETY = 5
    """A safety condition or a limit refused or ended the motion."""

    STORAGE = 6
    """The data could not be stored."""

    FAULT = 70
    """The program has a fault."""

    INTERRUPTED = 130
    """The operator stopped the run."""

    READER_GONE = 141
    """Whoever read stdout has gone; what shells report of a program that ends by SIGPIPE."""

    TERMINATED = 143
    """The run was terminated from outside."""
