"""The control port: truth and faults for tests, outside the protocols of the instruments."""
