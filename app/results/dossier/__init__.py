"""The day of a cell on one page: a certificate, then each stage of its way."""
