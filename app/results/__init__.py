"""What stored runs and results say: computed and phrased, drawn by others."""
