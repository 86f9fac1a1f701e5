"""From answers to a cell file; what is wrong with an answer is said by the file's own model."""
