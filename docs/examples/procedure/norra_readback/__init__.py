"""A procedure for catseye: commanded and reported joint angles."""
