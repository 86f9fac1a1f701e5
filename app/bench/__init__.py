"""The bench as clients see it: between runs and during them, moved by hand, its raw traffic."""
