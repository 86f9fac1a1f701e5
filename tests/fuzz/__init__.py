"""Random and mutated input, for short tests of the suite and for `make campaign-fuzz`."""
