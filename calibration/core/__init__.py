"""The algebra that every model of an arm stands on: rows and named parameters, nothing else.

A model (`model.Model`) shows parameters with names, units and a gauge; rows as residuals and a Jacobian; which rows
repeat each other; and the errors of the rows, white ones and shared ones. Everything here follows from these: the
estimate with its covariance (`estimation`), null directions by name (`rank`), the covariance taken apart
(`contributions`), Monte Carlo (`draws`), robust estimates (`robust`), what a fit leaves (`projection`, `residuals`,
`cross_validation`), and which rows to measure (`design`). Rows are lengths in mm, statistics of residuals in µm.
"""
