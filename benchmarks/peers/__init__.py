"""Other programs, set up to run as fast as they can."""
