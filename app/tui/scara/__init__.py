"""What the screens know of a SCARA: its bench from above, the keys that move it, its reflectors."""
