"""Work that is shared over processes and machines."""
