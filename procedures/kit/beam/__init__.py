"""What every measurement with a beam needs."""
