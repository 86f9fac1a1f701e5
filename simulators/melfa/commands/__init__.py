"""Commands of the R-protocol, one module for each section of the sheet; `table` joins them."""
