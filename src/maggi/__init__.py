"""maggi: mechanisms whose parts bend, by Maggi's equations."""

__version__ = "0.1.0"
