"""Each interferometer's driver against its own emulator, in memory."""
