"""The algebra of rows and named parameters that every model of an arm stands on."""
