"""The conformance suite for drivers: `pytest --pyargs catseye.app.testing.conformance --driver NAME`.

NAME is an entry point in `catseye.drivers`. Without `--endpoint` the driver talks to the built-in emulator of the
same name; with it, to whatever is there. See docs/write-a-driver.md.
"""

import pytest

from catseye.app.testing.candidate import Candidate
from catseye.app.testing.checks.catalogue import applicable
from catseye.app.testing.checks.check import Check, run_check
from catseye.app.testing.conformance_options import CANDIDATE
from catseye.app.testing.trial import NotApplicableError


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Make one test of each check that applies."""
    candidate = metafunc.config.stash[CANDIDATE]
    checks = applicable(candidate)
    metafunc.parametrize(
        ("check", "candidate"), [(check, candidate) for check in checks], ids=[c.name for c in checks]
    )


def test_driver(check: Check, candidate: Candidate) -> None:
    """The driver does what the check asks."""
    try:
        run_check(check, candidate)
    except NotApplicableError as reason:
        pytest.skip(str(reason))
