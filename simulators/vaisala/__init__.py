"""The ASCII interface of Vaisala's PTU300 family."""
