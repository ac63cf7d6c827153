"""What the figures were measured on."""

from __future__ import annotations

import datetime
import os
import platform
import subprocess
from importlib import metadata
from pathlib import Path

PACKAGES = ("numpy", "scipy", "numba", "rslab", "exudyn")
ROOT = Path(__file__).resolve().parent.parent.parent


def description() -> list[tuple[str, str]]:
    """Pairs of what and which."""
    return [
        ("date", datetime.date.today().isoformat()),
        ("commit", commit()),
        ("processor", processor()),
        ("cores", str(len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count())),
        ("memory", memory()),
        ("system", platform.platform(terse=True)),
        ("Python", platform.python_version()),
        *((name, version(name)) for name in PACKAGES),
    ]


def processor() -> str:
    """Its name and instruction set, as far as the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    fields = dict(line.split(":", 1) for line in lines if ":" in line)
    known = {key.strip(): value.strip() for key, value in fields.items()}
    flags = known.get("flags", "").split()
    vectors = next((name for name in ("avx512f", "avx2", "avx") if name in flags), "")
    return ", ".join(part for part in (known.get("model name", platform.machine()), vectors) if part)


def memory() -> str:
    """In GiB."""
    try:
        return f"{os.sysconf('SC_PHYS_PAGES') * os.sysconf('SC_PAGE_SIZE') / 2**30:.0f} GiB"
    except (ValueError, OSError):
        return "unknown"


def version(package: str) -> str:
    """Its version, or that it is missing."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def commit() -> str:
    """The commit that is checked out, and whether anything is changed; unknown outside a repository."""
    try:
        answer = subprocess.run(
            ["git", "describe", "--always", "--dirty=, changed"], cwd=ROOT, capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return answer.stdout.strip()
