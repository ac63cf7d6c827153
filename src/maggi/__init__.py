"""maggi: mechanisms whose parts bend, by Maggi's equations."""

from pathlib import Path

from . import _numba_cache

__version__ = "0.1.0"

_numba_cache.configure(Path(__file__).resolve().parent)
