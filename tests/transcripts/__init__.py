"""Bytes of the protocols, from public sources; drivers and emulators are held to the same ones."""
