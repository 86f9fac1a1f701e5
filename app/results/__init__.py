"""What a run and its analyses say: results as data, numbers as people read them."""
