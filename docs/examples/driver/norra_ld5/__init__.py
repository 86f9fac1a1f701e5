"""catseye driver for the Norra LD5 displacement display (a fictitious instrument)."""
