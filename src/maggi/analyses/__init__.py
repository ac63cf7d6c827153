"""Analyses of a system: initial state, quasi-static balance, transient."""
