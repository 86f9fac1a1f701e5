"""A day or a night from a file: stages one after another without anybody there, each with a verdict."""
