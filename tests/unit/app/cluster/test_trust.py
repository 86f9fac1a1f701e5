"""Work goes over the network encrypted, or after the user has said that it need not be."""

import pytest

from catseye.app.cluster.sharing import require_trusted, sharing
from catseye.app.errors import ConfigError, exit_code_of
from catseye.app.exitcode import ExitCode

OUTSIDE = [
    "tcp://192.168.0.7:8786",
    "10.0.0.7:8786",
    "tcp://bench.example:8786",
    "tcp://0.0.0.0:8786",
    "tcp://[::]:8786",
    "tcp://[fe80::1]:8786",
    "ucx://10.0.0.7:13337",
    "ws://10.0.0.7:8786",
    "tcp://localhost.example:8786",
    "tcp://127.0.0.1@10.0.0.7:8786",
    "",
]


@pytest.mark.parametrize("address", OUTSIDE)
def test_a_scheduler_outside_of_this_machine_needs_tls(address: str) -> None:
    with pytest.raises(ConfigError, match="--insecure-cluster") as caught, sharing(1, address):
        pass
    assert exit_code_of(caught.value) is ExitCode.USAGE


@pytest.mark.parametrize("address", OUTSIDE)
def test_the_user_may_trust_the_network(address: str) -> None:
    require_trusted(address, insecure=True)


@pytest.mark.parametrize(
    "address",
    [
        "tcp://127.0.0.1:8786",
        "127.0.0.1:8786",
        "tcp://127.3.2.1:8786",
        "tcp://[::1]:8786",
        "tcp://localhost:8786",
        "tls://10.0.0.7:8786",
        "wss://bench.example:8786",
    ],
)
def test_this_machine_and_tls_are_trusted(address: str) -> None:
    require_trusted(address, insecure=False)


def test_an_address_that_is_none_is_named() -> None:
    with pytest.raises(ConfigError, match="give the address as"):
        require_trusted("tcp://[::1:8786", insecure=False)
