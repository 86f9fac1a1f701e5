"""What emulators listen on: sockets, pseudo-terminals and datagrams."""
