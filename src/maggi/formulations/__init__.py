"""Lagrange, Gibbs–Appell, Kane, Newton–Euler: the same question as Maggi's equations, answered independently.

Nothing here sees `projection`. Gibbs–Appell, Kane and Newton–Euler are computed from the motion of mass points and from
joints written out geometrically a second time, so that they cannot share a mistake with the program's matrices.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from .gibbs_appell import gibbs_appell
from .kane import kane
from .lagrange import lagrange
from .newton_euler import newton_euler
from .question import Answer, Question, question_at

FORMULATIONS: Mapping[str, Callable[[Question], Answer]] = MappingProxyType(
    {"Lagrange": lagrange, "Gibbs–Appell": gibbs_appell, "Kane": kane, "Newton–Euler": newton_euler}
)

__all__ = ["FORMULATIONS", "Answer", "Question", "gibbs_appell", "kane", "lagrange", "newton_euler", "question_at"]
