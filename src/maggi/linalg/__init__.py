"""Rotations and rigid motions, and sparse factorisation behind one small protocol."""
