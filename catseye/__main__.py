"""Lets `python -m catseye` stand for the `catseye` command."""

from catseye.app.cli import main

main()
