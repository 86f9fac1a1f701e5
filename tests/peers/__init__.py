"""Public clients of the protocols, unmodified, against the emulators: make peers."""
