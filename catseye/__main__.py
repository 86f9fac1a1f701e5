"""Lets `python -m catseye` stand for the `catseye` command."""

from catseye.app.entry import main

main()
