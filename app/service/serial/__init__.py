"""Emulated benches of serial arms."""
