"""Normal equations summed up block by block: rows that need not fit into memory."""
