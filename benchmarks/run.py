"""All benchmarks in a short form: each prints its own table. Medians and ratios; the machine may be noisy."""

from __future__ import annotations

import platform
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
SHORT: dict[str, list[str]] = {
    "hinged_bar.py": ["--steps", "200"],
    "assembly.py": [],
    "small_system.py": [],
    "long_run.py": ["--steps", "20000"],
}


def main() -> int:
    print(f"{platform.processor() or platform.machine()}, Python {platform.python_version()}\n", flush=True)
    chosen = sys.argv[1:] or list(SHORT)
    status = 0
    for name in chosen:
        script = HERE / (name if name.endswith(".py") else f"{name}.py")
        if not script.is_file():
            print(f"there is no benchmark {name!r}; there are {', '.join(SHORT)}", file=sys.stderr)
            return 2
        status |= subprocess.run([sys.executable, str(script), *SHORT.get(script.name, [])], check=False).returncode
        print(flush=True)
    return status


if __name__ == "__main__":
    sys.exit(main())
