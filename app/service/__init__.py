"""The engine as a service: clients over a Unix-domain socket."""
