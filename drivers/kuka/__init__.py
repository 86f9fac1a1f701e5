"""KUKA controllers over KUKAVARPROXY or C3 Bridge, with the program CATSKUKA on the controller."""
