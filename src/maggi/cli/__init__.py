"""The command `maggi`: thin commands over the public interface; no mechanics here.

Whatever is slow to import (numba, h5py, matplotlib, rich) is imported inside the commands that need it, so
that ``maggi --help`` and mistakes in the command line answer at once.
"""

import os

# The BLAS of numpy and that of scipy each begin threads, which first wait, busy, for 2²⁶ cycles of the clock: now 2¹⁶. Read when
# they are loaded.
os.environ.setdefault("OPENBLAS_THREAD_TIMEOUT", "16")
