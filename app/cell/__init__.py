"""The cell file: what stands on the bench, strictly checked."""
