"""For developers of drivers: emulators as pytest fixtures and a conformance suite."""
