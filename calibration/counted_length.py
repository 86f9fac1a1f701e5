"""Lengths counted in vacuum wavelengths, turned into lengths in air."""


def compensated_mm(vacuum_mm: float, n_now: float, n_zero: float, dead_path_mm: float) -> float:
    """Return the displacement since the zero.

    The instrument counts n·(D + L) − n₀·D in vacuum wavelengths. Division by n alone would leave the air's change
    along the dead path D in the displacement L.

    Args:
        vacuum_mm: displacement as counted, in vacuum wavelengths, mm.
        n_now: refractive index of the air now.
        n_zero: the same at the zero.
        dead_path_mm: length of the beam at the zero, mm.
    """
    return vacuum_mm / n_now - dead_path_mm * (n_now - n_zero) / n_now
