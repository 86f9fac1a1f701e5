"""Options and summary of the conformance suite; loaded when the suite is asked for by its name."""

import pytest

from catseye.app.testing.candidate import Candidate, bytes_of, candidate_of, parse_setting
from catseye.app.testing.checks.catalogue import not_applicable

CANDIDATE = pytest.StashKey[Candidate]()
"""The driver under examination."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options of the suite."""
    group = parser.getgroup("catseye driver conformance")
    group.addoption("--driver", metavar="NAME", help="entry point of the driver in catseye.drivers")
    group.addoption(
        "--endpoint", metavar="URL", help="of a device or emulator; default: the built-in emulator"
    )
    group.addoption(
        "--control", metavar="URL", help="of the control port of the emulated bench behind --endpoint"
    )
    group.addoption(
        "--streaming",
        metavar="TEXT",
        default="",
        help=r"makes the device send without being asked, with escapes such as \r: 'R\r'",
    )
    group.addoption(
        "--setting",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="a setting of the driver; may be repeated",
    )
    group.addoption(
        "--arm", metavar="NAME", help="description of a robot's arm; that of the built-in bench if left out"
    )
    group.addoption(
        "--allow-motion", action="store_true", help="the robot behind --endpoint may move, slowly"
    )


def pytest_configure(config: pytest.Config) -> None:
    """Find the driver.

    Raises:
        pytest.UsageError: there is none of that name, or an option is wrong.
    """
    if config.option.help:
        return
    name = config.getoption("--driver")
    if not name:
        raise pytest.UsageError(
            "the conformance suite needs --driver NAME, an entry point in catseye.drivers"
        )
    try:
        config.stash[CANDIDATE] = candidate_of(
            name,
            endpoint=config.getoption("--endpoint"),
            settings=dict(map(parse_setting, config.getoption("--setting"))),
            allow_motion=config.getoption("--allow-motion"),
            arm=config.getoption("--arm"),
            control=config.getoption("--control"),
            streaming=bytes_of(config.getoption("--streaming")),
        )
    except (LookupError, ValueError) as error:
        raise pytest.UsageError(str(error.args[0])) from error


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Say what was examined, and which checks did not apply and why."""
    candidate = config.stash[CANDIDATE]
    behind = candidate.endpoint or "the built-in emulator"
    terminalreporter.section(f"conformance of {candidate.name}, {candidate.role} driver, with {behind}")
    for name, reason in not_applicable(candidate).items():
        terminalreporter.write_line(f"not applicable: {name}: {reason}")
    for report in terminalreporter.stats.get("skipped", []):
        name, (_, _, reason) = report.nodeid.rpartition("[")[2].rstrip("]"), report.longrepr
        terminalreporter.write_line(f"not applicable: {name}: {reason.removeprefix('Skipped: ')}")
