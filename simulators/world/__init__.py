"""The physical truth: arm, beam, counter and air. No clock and no I/O; bench time is driven from outside."""
