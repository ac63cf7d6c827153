"""``python -m maggi`` is the command ``maggi``."""

from .cli.main import main

if __name__ == "__main__":
    main()
