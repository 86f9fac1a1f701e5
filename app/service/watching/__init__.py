"""The devices of a cell for whoever watches: between runs and during them."""
