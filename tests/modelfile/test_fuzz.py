"""Random damage to good model texts: a model or a ModelError, never anything else."""

from __future__ import annotations

from collections.abc import Callable

from hypothesis import given, settings
from hypothesis import strategies as st

from maggi.model.errors import ModelError
from maggi.modelfile import read_text

from .samples import CONTRACT, EVERYTHING, LIBRARY, SIMEON_ROD

PIECES = [
    "",
    "§",
    ":",
    ": ",
    "- ",
    "[",
    "]",
    "{",
    "}",
    ",",
    '"',
    "'",
    "\n",
    "\n  ",
    "\t",
    "&a ",
    "*a",
    "!!x ",
    "#",
    "|",
    ">",
]
PIECES += [
    "null",
    "true",
    "1e400",
    "-1",
    "0",
    "1e-3",
    ".nan",
    "3 mm",
    "3 furlongs",
    "t",
    "speed*t",
    "1/0",
    "[]",
    "{}",
    "~",
]
PIECES += [
    "ground",
    "rod",
    "crank.pin",
    "kind",
    "auto",
    "\x00",
    "\x1b",
    "é",
    "\u2028",
    "\ufeff",
    "9" * 400,
    "<<",
    "? ",
    "---\n",
    "%YAML 1.1\n",
]
PIECES += [
    "[key]",
    "<rigid>",
    "x" * 200,
    "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]",
    "{at: [0, 0, 0]}",
    "!!python/name:os.system",
]
PIECES += [
    "s",
    "0*s",
    "1/s",
    "a.v.x",
    "crank.angle",
    "crank.",
    ".angle",
    "first.r11",
    "first.v.x*first.v.y",
    "{file: /dev/zero}",
    "{radius: s}",
    "{implicit: x}",
    "constant",
    "relation",
]

TEXTS = st.sampled_from([CONTRACT, EVERYTHING, SIMEON_ROD, LIBRARY, LIBRARY])
Damage = Callable[[str], str]


@st.composite
def damaged(draw: st.DrawFn) -> str:
    """A good text with up to four pieces of it cut, doubled or replaced, at places where words begin or anywhere."""
    text = draw(TEXTS)
    for _ in range(draw(st.integers(1, 4))):
        start = draw(st.integers(0, len(text)))
        end = min(len(text), start + draw(st.integers(0, 30)))
        piece = draw(st.sampled_from(PIECES) | st.text(max_size=5) | st.just(text[start:end] * 2))
        text = text[:start] + piece + text[end:]
    return text


@st.composite
def one_value_changed(draw: st.DrawFn) -> str:
    """A good text with one word exchanged for another of the file or of the list: mostly still YAML."""
    text = draw(TEXTS)
    words = [word for word in text.replace("\n", " \n ").split(" ") if word.strip()]
    old = draw(st.sampled_from(words))
    return text.replace(old, draw(st.sampled_from(PIECES + words)), 1)


@given(damaged() | one_value_changed() | st.text(max_size=80))
@settings(max_examples=300, deadline=None)
def test_damage_gives_a_model_or_a_model_error(text: str) -> None:
    try:
        model, source = read_text(text, name="fuzz.yml", folder="/nonexistent")
    except ModelError:
        return
    assert model.bodies
    assert source.place("bodies").line > 0


@given(
    st.lists(
        st.sampled_from(
            ["simulation", "step", "bodies", "crank", "joints", "0", "a", "", "=", ".", "[", "1e-3", "3 mm", ": "]
        ),
        max_size=6,
    )
)
@settings(max_examples=80, deadline=None)
def test_any_override_gives_a_model_or_a_model_error(parts: list[str]) -> None:
    try:
        read_text(EVERYTHING, overrides=[".".join(parts[:3]) + "=" + "".join(parts[3:])])
    except ModelError:
        return
