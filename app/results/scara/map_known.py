"""How well the maps were known while they were measured: what the event "map-known" of a run holds."""

from catseye.app.results.document import Document


class MapKnown(Document):
    """What was known when a row of J2 was done.

    Attributes:
        reflector: that was measured.
        theta1_deg: command of J1 in that row.
        direction1: state of approach of J1 in that row, 1 or -1.
        u_theta1_mdeg: largest standard uncertainty of the map of J1; None where it is not known yet.
        u_theta2_mdeg: the same of J2.
        text: why nothing is known.
    """

    reflector: str | None = None
    theta1_deg: float | None = None
    direction1: int | None = None
    u_theta1_mdeg: float | None = None
    u_theta2_mdeg: float | None = None
    text: str = ""

    @property
    def u_mdeg(self) -> dict[str, float | None]:
        """Largest standard uncertainty of each map, by its name."""
        return {"Δθ1": self.u_theta1_mdeg, "Δθ2": self.u_theta2_mdeg}
