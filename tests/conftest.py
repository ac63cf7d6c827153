"""What every test shares: how hypothesis looks for counterexamples."""

import os

from hypothesis import settings

# No deadline: the first example of a test may compile kernels. In continuous integration the examples are the same
# every time, so that a red run can be repeated.
settings.register_profile("maggi", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "maggi")
