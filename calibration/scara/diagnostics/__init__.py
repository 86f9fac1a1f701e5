"""What speaks against a fit: residuals, outliers, drift, lack of fit, cross-validation, richer models."""
