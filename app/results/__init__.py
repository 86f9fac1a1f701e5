"""What analyses find and say: computed from stored runs and result files, as data for every front end."""
