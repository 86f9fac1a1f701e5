"""What emulated instruments may know: for every protocol, no answer is the bench's truth."""
