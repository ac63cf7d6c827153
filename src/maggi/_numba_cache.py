"""Where numba keeps the compiled kernels: a folder for each state of the sources that the kernels are made from.

Numba's own cache notices an edit only in the file of the kernel itself; a kernel whose callee or constant in another
file was edited would go on with the old machine code. So the folder's name is a hash of every source that a kernel can
see and of the versions of what compiles it. Must run before numba is imported, and must itself be quick to import.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

VARIABLE = "NUMBA_CACHE_DIR"
# Remembers what was set here, for child processes: their sources may have been edited since.
OWN_VARIABLE = "MAGGI_NUMBA_CACHE_DIR"
# Folders of other states of the sources are removed when they are not among the latest and unused for a day: a run
# that started before an edit still writes to its own.
KEPT_FOLDERS = 4
KEPT_SECONDS = 86_400.0

Module = tuple[str, ...]

# An import statement: either `from module import names` (in parentheses or not) or `import modules`.
IMPORT = re.compile(rb"\n[ \t]*(?:from[ \t]+([.\w]+)[ \t]+import[ \t]*(\([^)]*\)|[^\n]*)|import[ \t]+([^\n]*))")
WORD = re.compile(rb"[.\w]+")
# Modules of kernels import numba, or the decorators that stand for it.
NUMBA = re.compile(rb"\n[ \t]*(?:from|import)[ \t]+(?:numba|[.\w]*\bcompiling)\b")
COMPILERS = (("numba", "_version.py"), ("llvmlite", "_version.py"), ("numpy", "version.py"))


def configure(package: Path) -> None:
    """Points numba to the cache folder of the package's present sources, unless the user has chosen a folder.

    The folder is in the package's `__pycache__`, in the user's cache folder where that cannot be written to, and where
    even that cannot, in a temporary folder of this process.
    """
    given = os.environ.get(VARIABLE)
    if given and given != os.environ.get(OWN_VARIABLE):
        return
    try:
        key = source_key(package)
    except OSError:  # the sources are not files: numba's own cache does not apply either
        return
    folder = make_folder((package / "__pycache__" / "numba", *user_cache()), key)
    os.environ[VARIABLE] = os.environ[OWN_VARIABLE] = str(folder)
    if "numba" in sys.modules:  # it has read its environment already
        sys.modules["numba"].config.CACHE_DIR = str(folder)


def source_key(package: Path) -> str:
    """A hash of the sources that kernels are made from, of the compilers' versions and of Python's."""
    texts = sources(package)
    digest = hashlib.sha256(sys.version.encode())
    for name, file in COMPILERS:
        spec = find_spec(name)
        for location in (spec.submodule_search_locations or ()) if spec else ():
            digest.update((Path(location) / file).read_bytes())
    texts.pop((package.name, "__init__"), None)  # the facade names everything and holds no kernel
    for module in seen_by_kernels(texts):
        digest.update(b"%s\0%d\0" % (".".join(module[1:]).encode(), len(texts[module])))
        digest.update(texts[module])
    return digest.hexdigest()[:20]


def sources(package: Path) -> dict[Module, bytes]:
    """The text of every module of a package by its name in parts, that of a package ending in ``__init__``.

    With strings for paths: this is done at every start.
    """
    texts: dict[Module, bytes] = {}
    waiting: list[tuple[str, Module]] = [(str(package), (package.name,))]
    while waiting:
        folder, inside = waiting.pop()
        with os.scandir(folder) as entries:
            for entry in entries:
                if entry.name.endswith(".py"):
                    with open(entry.path, "rb") as file:
                        texts[(*inside, entry.name.removesuffix(".py"))] = file.read()
                elif entry.is_dir() and entry.name != "__pycache__":
                    waiting.append((entry.path, (*inside, entry.name)))
    return texts


def seen_by_kernels(texts: dict[Module, bytes]) -> list[Module]:
    """The modules that import numba, or `compiling`, and, transitively, those that they import, packages' `__init__` included; sorted.

    Whatever is named after `import` counts, a module or not, and so does a name in a text that looks like an import:
    now and then one too many, never one too few.
    """
    modules = {module[:-1] if module[-1] == "__init__" else module: module for module in texts}
    waiting = [module for module, text in texts.items() if NUMBA.search(b"\n" + text)]
    seen = set(waiting)
    while waiting:
        module = waiting.pop()
        for dotted in imported(texts[module], module[:-1]):
            found = {modules[part] for k in range(len(dotted)) if (part := dotted[: k + 1]) in modules} - seen
            seen |= found
            waiting += found
    return sorted(seen)


def imported(text: bytes, inside: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Dotted names of everything that a module of the package `inside` imports; of `from a import b` that is a.b."""
    for base, listed, plain in IMPORT.findall(b"\n" + text):
        if plain:
            yield from (tuple(word.decode().split(".")) for word in WORD.findall(plain))
            continue
        rest = base.lstrip(b".")
        level = len(base) - len(rest)
        start = inside[: len(inside) + 1 - level] if level else ()
        module = (*start, *(rest.decode().split(".") if rest else ()))
        yield from ((*module, name.decode()) for name in WORD.findall(listed))


def make_folder(parents: tuple[Path, ...], key: str) -> Path:
    """The folder `key` in the first of the parents that can be written to; a temporary one where none can."""
    for parent in parents:
        folder = parent / key
        try:
            is_new = not folder.is_dir()
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
            os.utime(folder)
        except OSError:
            continue
        if is_new:
            remove_old(parent)
        return folder
    # Private to this process: cached code is loaded as it is, so that nobody else may be able to put it there.
    temporary = tempfile.mkdtemp(prefix="maggi-numba-")
    atexit.register(shutil.rmtree, temporary, ignore_errors=True)
    return Path(temporary)


def remove_old(parent: Path) -> None:
    """Removes the folders of earlier states of the sources that are no longer used."""
    ages: list[tuple[float, Path]] = []
    for folder in parent.iterdir():
        try:
            ages.append((time.time() - folder.stat().st_mtime, folder))
        except OSError:  # another process was quicker
            continue
    for age, folder in sorted(ages)[KEPT_FOLDERS:]:
        if age > KEPT_SECONDS:
            shutil.rmtree(folder, ignore_errors=True)


def user_cache() -> tuple[Path, ...]:
    """The folder for this program's caches by the platform's convention; none for a user without a home."""
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA", "~/AppData/Local")
    elif sys.platform == "darwin":
        base = "~/Library/Caches"
    else:
        base = os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    try:
        return (Path(base).expanduser() / "maggi" / "numba",)
    except RuntimeError:
        return ()
