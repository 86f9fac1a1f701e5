"""Instrument drivers: one plain class per instrument over a Transport, a pure codec beside it."""
