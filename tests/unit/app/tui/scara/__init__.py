"""What the screens know of a SCARA."""
