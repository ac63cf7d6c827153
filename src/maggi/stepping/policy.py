"""How many back-substitutions a step needs: one where the motion is smooth, more where the iteration says so."""

from __future__ import annotations

from dataclasses import dataclass

CHECK_SOLVES = 3  # back-substitutions of a check: the ratio of its last two corrections is the contraction
ROUGH = 0.3  # with linear prediction an iteration factor beyond −1/3 is unstable (Theory §5)
CALM = 0.03  # contraction up to which the next check may wait LONGER
FIRST_WAIT, LONGER, LONGEST_WAIT = 10, 4, 320  # steps from one check to the next; times as long
SUDDEN = 2.0  # a first correction this many times as large as usual calls for a check at once
FADING, RISING = 0.97, 1.02  # per step, of what is usual: an unstable component grows by 1.15 and more
MOST = 12  # back-substitutions before a step is given up
FIRST = 3  # steps at the start, or after a change of step, that are iterated fully


@dataclass
class SolvePolicy:
    """Decides after every back-substitution whether the step needs another.

    The first contraction of a step is no sign (it shows the smooth part, while a rough component decides the
    stability), so now and then a step is a check of CHECK_SOLVES, and the contraction of the later ones decides: above
    ROUGH all steps take two. Checks follow each other after FIRST_WAIT steps, and LONGER times as many each time as
    long as the contraction stays below CALM, a tenth of what would be dangerous; between them a component that grows
    shows in the first correction, which is there anyway: one that is SUDDENly larger than usual, and large
    enough to matter, makes its step a check. The error that is left, ``correction·ρ/(1 − ρ)``, must be below
    the tolerance in any case. `exact` iterates every step to round-off, for comparisons.
    """

    exact: bool = False
    contraction: float = 0.1
    wait: int = FIRST_WAIT
    since_check: int = FIRST_WAIT
    young: int = 0
    usual: float = 0.0
    alarmed: bool = False
    first: float = 0.0
    ratio: float | None = None

    def restart(self) -> None:
        """After a start or a change of step."""
        self.young = 0
        self.wait = self.since_check = FIRST_WAIT
        self.usual = 0.0

    @property
    def checking(self) -> bool:
        """Whether this step is a check."""
        return self.exact or self.alarmed or self.young < FIRST or self.since_check >= self.wait - 1

    def enough(self, corrections: list[float], allowed: float, floor: float) -> bool:
        """Whether a step may end after these corrections (sizes of δ, first to last).

        allowed : correction that the tolerance allows to be left. floor : what is round-off.
        """
        last = corrections[-1]
        count = len(corrections)
        if count == 1:
            self.first, self.ratio = last, None
            # with a contraction of ROUGH it would already leave too much
            matters = last * ROUGH / (1.0 - ROUGH) > allowed
            self.alarmed = self.young >= FIRST and matters and last > SUDDEN * self.usual
        if last <= floor:
            return True
        if count >= 2:
            ratio = last / corrections[-2]
            if count >= 3:
                self.contraction = self.ratio = min(ratio, 0.99)
        else:
            ratio = self.contraction
        if self.exact:
            return last <= 1e-4 * allowed
        needed = CHECK_SOLVES if self.checking else (2 if self.contraction > ROUGH else 1)
        rho = min(max(self.contraction, ratio if count >= 3 else 0.0), 0.99)
        return count >= needed and last * rho / (1.0 - rho) <= allowed

    def accepted(self) -> None:
        """A step has ended."""
        checked = self.checking
        if not checked:
            self.since_check += 1
        else:
            # corrections that fell to round-off before they could show a ratio are as calm as can be
            if self.ratio is not None and self.ratio > CALM:
                self.wait = FIRST_WAIT
            elif self.young >= FIRST and not self.alarmed:
                self.wait = min(LONGER * self.wait, LONGEST_WAIT)
            self.since_check = 0
        risen = self.first if checked else min(self.first, RISING * self.usual)
        self.usual = max(FADING * self.usual, risen)
        self.alarmed = False
        self.young += 1
