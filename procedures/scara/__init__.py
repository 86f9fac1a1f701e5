"""Procedures of a SCARA that carries an interferometer and aims its beam itself."""
