"""The automated open-loop tracking measurement."""
