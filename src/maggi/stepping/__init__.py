"""The implicit step (Theory §5)."""
