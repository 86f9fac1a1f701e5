"""A KUKA KR C4 with the proxy of its variables, written from the sheet `kuka_abb_robodk`, section A1."""
