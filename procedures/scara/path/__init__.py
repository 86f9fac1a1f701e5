"""The bidirectional validation path, by tracker, interferometer or a file."""
