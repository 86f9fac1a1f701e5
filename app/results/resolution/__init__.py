"""Motion resolution of joints and Cartesian directions: result files, tables, figures, reports."""
