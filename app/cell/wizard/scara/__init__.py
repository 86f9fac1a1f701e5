"""What the wizard asks about a SCARA and its interferometer."""
