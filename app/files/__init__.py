"""Files that others may rely on: points CSV, result JSON; written whole or not at all."""
