"""Writes requirements.txt, requirements-dev.txt and requirements-bench.txt: versions with the hash of every usable wheel.

    .venv/bin/python tools/pin.py [--bench]

To renew the pins, install the wanted versions into .venv first. Names, versions and markers come from what is installed
and from pyproject.toml, those of the benchmarks' peers, which are never installed there, from below (--bench renews them
alone); the hashes come from the package index that pip is set up to use, without downloading wheels.
The wheels listed are those for CPython 3.11 to 3.14 on every platform.
"""

from __future__ import annotations

import re
import sys
import tomllib
from importlib import metadata
from pathlib import Path

from pip._internal.commands import create_command
from pip._internal.index.collector import LinkCollector, parse_links
from pip._internal.req.constructors import install_req_from_line
from pip._vendor.packaging.utils import canonicalize_name, parse_wheel_filename

ROOT = Path(__file__).resolve().parent.parent
BUILD_BACKEND = ["setuptools", "wheel"]
# Needed on other platforms than the one that this runs on: name to version and marker.
ELSEWHERE = {"colorama": ("0.4.6", 'sys_platform == "win32"')}
# What the benchmarks compare with; needs nothing that maggi does not.
PEERS = {"exudyn": "1.13.6"}
INTERPRETERS = {"cp311", "cp312", "cp313", "cp314", "py3"}


def closure(roots: list[str]) -> dict[str, str]:
    """Name to installed version of the roots and of everything they need."""
    found: dict[str, str] = {}
    waiting = [requirement for requirement in roots if applies(requirement)]
    while waiting:
        name = canonicalize_name(re.split(r"[^\w.-]", waiting.pop())[0])
        if name not in found:
            distribution = metadata.distribution(name)
            found[name] = distribution.version
            waiting += [need for need in distribution.requires or [] if applies(need)]
    return found


def applies(requirement: str) -> bool:
    """Whether a plain install here needs it: no extra, and its marker, if any, holds."""
    marker = requirement.partition(";")[2]
    return "extra" not in marker and (not marker or install_req_from_line(requirement).match_markers())


def wheels(collector: LinkCollector, name: str, version: str) -> list[str]:
    """The sha256 of every wheel of a release that fits one of `INTERPRETERS`."""
    hashes = set()
    sources = collector.collect_sources(name, candidates_from_page=lambda _: [])
    for source in (*sources.find_links, *sources.index_urls):
        page = collector.fetch_response(source.link) if source and source.link else None
        for link in parse_links(page) if page else ():
            if not link.is_wheel or link.hash_name != "sha256":
                continue
            _, release, _, tags = parse_wheel_filename(link.filename)
            usable = any(tag.interpreter in INTERPRETERS or tag.abi == "abi3" for tag in tags)
            if str(release) == version and usable and not any(tag.abi.endswith("t") for tag in tags):
                hashes.add(link.hash)
    return sorted(hashes)


def write(path: Path, head: str, pins: dict[str, str], collector: LinkCollector) -> None:
    """One requirements file: the head, then every pin with its hashes, by name."""
    lines = [head]
    for name, version in sorted(pins.items()):
        hashes = wheels(collector, name, version)
        if not hashes:
            raise SystemExit(f"{name} {version} has no wheel")
        marker = f" ; {ELSEWHERE[name][1]}" if name in ELSEWHERE else ""
        lines.append(" \\\n    ".join([f"{name}=={version}{marker}", *(f"--hash=sha256:{value}" for value in hashes)]))
        print(f"{name}=={version}: {len(hashes)} wheels")
    path.write_text("\n".join(lines) + "\n")


def main() -> None:
    """Writes all files, or that of the benchmarks alone."""
    command = create_command("download")
    options, _ = command.parse_args([])
    with command.main_context():
        collector = command._build_package_finder(options, command.get_default_session(options))._link_collector
        head = "# Written by tools/pin.py: what the benchmarks compare with. Not everywhere to be had; see ./dev.\n"
        write(ROOT / "requirements-bench.txt", head, PEERS, collector)
        if sys.argv[1:] == ["--bench"]:
            return
        project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
        core = closure(project["dependencies"] + BUILD_BACKEND) | {name: pin[0] for name, pin in ELSEWHERE.items()}
        everything = closure(project["dependencies"] + BUILD_BACKEND + project["optional-dependencies"]["dev"])
        development = {name: version for name, version in everything.items() if name not in core}
        head = "# Written by tools/pin.py: what maggi runs on and is built with.\n"
        write(ROOT / "requirements.txt", head, core, collector)
        head = "# Written by tools/pin.py: what its tests and checks need besides.\n-r requirements.txt\n"
        write(ROOT / "requirements-dev.txt", head, development, collector)


if __name__ == "__main__":
    main()
