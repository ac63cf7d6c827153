"""The command `maggi`: thin commands over the public interface; no mechanics here.

Whatever is slow to import (numba, h5py, matplotlib, rich) is imported inside the commands that need it, so
that ``maggi --help`` and mistakes in the command line answer at once.
"""
