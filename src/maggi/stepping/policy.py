"""How many back-substitutions a step needs: one where the motion is smooth, more where the iteration says so."""

from __future__ import annotations

from dataclasses import dataclass

CHECK_EVERY = 10  # steps between two checks
CHECK_SOLVES = 3  # back-substitutions of a check: the ratio of its last two corrections is the contraction
ROUGH = 0.3  # with linear prediction an iteration factor beyond −1/3 is unstable (Theory §5)
MOST = 12  # back-substitutions before a step is given up
FIRST = 3  # steps at the start, or after a change of step, that are iterated fully


@dataclass
class SolvePolicy:
    """Decides after every back-substitution whether the step needs another.

    The first contraction of a step is no sign (it shows the smooth part, while a rough component decides the
    stability), so every CHECK_EVERY steps CHECK_SOLVES are made, and the contraction of the later ones decides:
    above ROUGH all steps take two. The error that is left, ``correction·ρ/(1 − ρ)``, must be below the tolerance
    in any case. `exact` iterates every step to round-off, for comparisons.
    """

    exact: bool = False
    contraction: float = 0.1
    since_check: int = CHECK_EVERY
    young: int = 0

    def restart(self) -> None:
        """After a start or a change of step."""
        self.young = 0
        self.since_check = CHECK_EVERY

    @property
    def checking(self) -> bool:
        """Whether this step is a check."""
        return self.exact or self.young < FIRST or self.since_check >= CHECK_EVERY - 1

    def enough(self, corrections: list[float], allowed: float, floor: float) -> bool:
        """Whether a step may end after these corrections (sizes of δ, first to last).

        allowed : correction that the tolerance allows to be left. floor : what is round-off.
        """
        last = corrections[-1]
        if last <= floor:
            return True
        count = len(corrections)
        if count >= 2:
            ratio = last / corrections[-2]
            if count >= 3:
                self.contraction = min(ratio, 0.99)
        else:
            ratio = self.contraction
        if self.exact:
            return last <= 1e-4 * allowed
        needed = CHECK_SOLVES if self.checking else (2 if self.contraction > ROUGH else 1)
        rho = min(max(self.contraction, ratio if count >= 3 else 0.0), 0.99)
        return count >= needed and last * rho / (1.0 - rho) <= allowed

    def accepted(self) -> None:
        """A step has ended."""
        self.since_check = 0 if self.checking else self.since_check + 1
        self.young += 1
