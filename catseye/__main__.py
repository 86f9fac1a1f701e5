"""Lets `python -m catseye` stand for the `catseye` command."""

from catseye.entry import main

main()
