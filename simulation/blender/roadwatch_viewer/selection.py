"""Which objects are drawn and how finely: thresholds on hardware use, with hysteresis so nothing flickers."""

from __future__ import annotations

from dataclasses import dataclass

from .placement import Placed
from .settings import DETAILS, Settings

DETAIL_MARGIN = 0.1
"""A detail that was drawn is kept until its distance is passed by this share."""


@dataclass(frozen=True)
class Drawn:
    """An object that is to be drawn, with one of `settings.DETAILS`."""

    placed: Placed
    detail: str


class Selector:
    """Chooses from one scene after the other; `settings` may be replaced at any time."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self._shown: dict[str, str] = {}

    def select(self, objects: tuple[Placed, ...]) -> list[Drawn]:
        """The objects to draw, nearest first."""
        candidates = sorted(filter(self._passes, objects), key=lambda placed: placed.distance_m)
        drawn = [Drawn(placed, self._detail(placed)) for placed in self._nearest(candidates)]
        self._shown = {each.placed.seen.key: each.detail for each in drawn}
        return drawn

    def _passes(self, placed: Placed) -> bool:
        """Whether range, score and state let it through; what is shown has a margin."""
        chosen, is_shown = self.settings, placed.seen.key in self._shown
        range_m = chosen.range_m + (chosen.range_margin_m if is_shown else 0.0)
        least = chosen.min_score - (chosen.score_margin if is_shown else 0.0)
        if placed.seen.state == "tentative" and not chosen.show_tentative:
            return False
        return placed.distance_m <= range_m and placed.seen.score >= least

    def _nearest(self, candidates: list[Placed]) -> list[Placed]:
        """The `most_objects` nearest of candidates in order of distance.

        A shown object counts as `distance_margin_m` nearer than it is, as long as it is not `rank_margin`
        places or more beyond the last place.
        """
        most = self.settings.most_objects
        if len(candidates) <= most:
            return candidates
        last_rank = most + self.settings.rank_margin

        def claim_m(rank: int) -> float:
            placed = candidates[rank]
            keeps = placed.seen.key in self._shown and rank < last_rank
            return placed.distance_m - (self.settings.distance_margin_m if keeps else 0.0)

        winners = sorted(range(len(candidates)), key=claim_m)[:most]
        return [candidates[rank] for rank in sorted(winners)]

    def _detail(self, placed: Placed) -> str:
        before = self._shown.get(placed.seen.key)
        chosen = self.settings
        finest = DETAILS.index(chosen.level_of_detail)
        by_distance = 0
        for level, limit_m in ((1, chosen.simple_beyond_m), (2, chosen.boxes_beyond_m)):
            if limit_m <= 0.0:
                continue
            was_coarser = before is not None and DETAILS.index(before) >= level
            factor = 1.0 - DETAIL_MARGIN if was_coarser else 1.0
            if before is not None and not was_coarser:
                factor = 1.0 + DETAIL_MARGIN
            if placed.distance_m > limit_m * factor:
                by_distance = level
        return DETAILS[max(finest, by_distance)]


class Pace:
    """Lets at most `rate_hz` moments a second through; 0 lets all through."""

    TOLERANCE = 0.1
    """A moment this share of a period early is still on time: cameras jitter."""

    def __init__(self) -> None:
        self._next_s: float | None = None

    def is_due(self, now_s: float, rate_hz: float) -> bool:
        """Whether to draw now; time that runs backwards starts anew."""
        if rate_hz <= 0.0:
            return True
        period_s = 1.0 / rate_hz
        if self._next_s is None or now_s < self._next_s - 2.0 * period_s:
            self._next_s = now_s
        if now_s < self._next_s - self.TOLERANCE * period_s:
            return False
        self._next_s = max(self._next_s, now_s - period_s) + period_s
        return True
