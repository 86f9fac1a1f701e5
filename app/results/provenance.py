"""Where a result file comes from."""

from catseye.app.results.model import Origin
from catseye.app.results.origin import origin_now
from catseye.app.results.uncertainty_part import ResultPart


class Provenance(ResultPart):
    """Where it comes from; whether of emulated devices is not known of a file of measured values.

    `interferometer` is its model and serial number; None where no run, or not every one of them, states the same.
    `unverified` says what speaks against runs that were changed after their end and used all the same; None for none.
    """

    runs: list[str]
    software: str
    created: str
    simulated: bool | None = None
    unverified: list[str] | None = None
    interferometer: str | None = None

    @property
    def origin(self) -> Origin:
        """Where a report that is made of it now comes from."""
        return origin_now(simulated=bool(self.simulated), unverified=self.unverified or ())
