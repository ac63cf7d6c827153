"""Maggi's projection, in null-space and range-space form (Eq. T8–T11)."""
