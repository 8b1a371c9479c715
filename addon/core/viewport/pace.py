"""Chooses how coarse a viewport's picture is while its camera moves."""

from __future__ import annotations

STEPS = (1, 2, 3, 4, 6, 8)
"""Widths of a picture's pixels, in pixels of the screen."""
FIRST_STEP = 4
SLOW, FAST = 0.066, 0.06
"""Seconds that a picture may take while the camera moves, and below which it gets more pixels."""
SHARE_OF_NEW = 0.25
"""Of a picture in the time that its width is taken to need: one that was held up says little."""
FORGET_AFTER = 30
"""Number of pictures after which a width that was too slow is tried again."""


def _mixed(old: float | None, new: float) -> float:
    return new if old is None else old + SHARE_OF_NEW * (new - old)


class Pace:
    """Chooses the width of a moving picture's pixels by the time that pictures take. `fixed`: that
    width for ever.
    """

    def __init__(self, fixed: int | None = None) -> None:
        self.step = fixed or FIRST_STEP
        self._fixed = fixed is not None
        self._seconds: dict[int, float] = {}
        self._pictures = 0

    @property
    def first_step(self) -> int:
        """Of a picture that finds all of its light itself."""
        return self.step if self._fixed else max(self.step, FIRST_STEP)

    def forget(self) -> None:
        """Forgets the times of another scene."""
        self._seconds.clear()

    def took(self, step: int, seconds: float) -> None:
        """Notes that a picture of this step took so many seconds."""
        if self._fixed or step != self.step:
            return
        at = STEPS.index(step)
        seconds = self._seconds[step] = _mixed(self._seconds.get(step), seconds)
        self._pictures += 1
        if self._pictures % FORGET_AFTER == 0 and at:  # something else may have slowed it down
            self._seconds.pop(STEPS[at - 1], None)
        if seconds > SLOW and at + 1 < len(STEPS):
            self.step = STEPS[at + 1]
        elif at:
            finer = STEPS[at - 1]
            # About half of the time is proportional to the number of pixels.
            expected = self._seconds.get(finer, seconds * 0.5 * (1 + (step / finer) ** 2))
            if expected < FAST:
                self.step = finer
