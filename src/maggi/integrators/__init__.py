"""Coefficients of time integration; no bodies in here."""
