"""Where the floor is in the picture, by its tags: measured once, and again when the camera has been moved. Pure.

Tags have corners as 4 x 2 pixels, in the order of `laser_bot_battle.apriltag`.
"""

from collections.abc import Iterable, Mapping

import numpy as np

from laser_bot_battle.tags import FLOOR_TAG_SIZE, TagPose
from server.overhead.troubles import Troubles
from server.overhead.view import Floats, Size, View

LEAST = 4  # tags that are needed
SPREAD = 0.3  # m; tags in a narrower strip are taken as lying in a line
OFF = 0.03  # m from where a tag should be: more has another reason than noise and print
UNLIKE = 0.015  # m; most tags whose corners are so far from where they belong in a tag are not the plan's
MOVED = 0.3  # s for which most tags are off until the camera counts as moved
UNSEEN = 1.0  # s without any of the tags until the picture is not taken for one of the floor any more
RETRY = 0.5  # s between two attempts to measure the floor
RENEW = 2.0  # s between two measurements, as nothing holds quite still
MOST_OFF = 2  # tags that may lie wrong while the floor is measured; each more costs much time to find


class FloorSight:
    """`view` is None as long as the floor is not known; `is_sure` says whether the last picture is one of it."""

    def __init__(self, tags: Mapping[int, TagPose], camera_height: float, troubles: Troubles) -> None:
        """`tags` as they are laid out; `camera_height` in m over the floor."""
        self._places = {number: corners_of(tag) for number, tag in tags.items()}
        self._camera_height, self._troubles = camera_height, troubles
        self.view: View | None = None
        self.is_sure = False
        self._seen = float("-inf")  # any tag
        self._used: frozenset[int] = frozenset()  # tags that `view` is made of
        self._tried = float("-inf")  # to measure it
        self._off_since: float | None = None  # most tags
        self.measurements: list[str] = []
        """for the log, until somebody takes them"""

    def see(self, tags: Mapping[int, Floats], size: Size, now: float) -> None:
        """The floor tags of a picture that was taken at `now` in s."""
        if self.view and self.view.size != size:
            self._forget()
            self.measurements.append(
                f"the camera's pictures are {size[0]} x {size[1]} now: the floor is measured again"
            )
        self._seen = now if tags else self._seen
        if self.view and now - self._seen >= UNSEEN:
            self._forget()
        if self.view:
            self._compare(self.view, tags, now)
        is_due = self._off_since is None and now - self._tried >= RENEW and self._used <= tags.keys()
        if self.view is None or is_due:
            self._measure(tags, size, now)
        self.is_sure = self.view is not None and self._off_since is None and bool(tags)

    def _forget(self) -> None:
        """It is measured at once."""
        self.view, self._off_since, self._tried = None, None, float("-inf")

    def _compare(self, view: View, tags: Mapping[int, Floats], now: float) -> None:
        far = self._far(view, tags)
        off = {number: miss for number, miss in far.items() if not miss <= OFF}
        if 2 * len(off) > len(far):
            self._off_since = now if self._off_since is None else self._off_since
            if now - self._off_since >= MOVED:
                self._forget()
                self.measurements.append("the camera has been moved: the floor is measured again")
            return
        self._off_since = None
        self._tell_off(off, now)

    def _measure(self, tags: Mapping[int, Floats], size: Size, now: float) -> None:
        obstacle = self._obstacle(tags)
        if not obstacle and now - self._tried >= RETRY:
            self._tried = now
            view, off = self._fit(tags, size)
            if view:
                if self.view is None:
                    good = len(tags) - len(off)
                    self.measurements.append(f"the floor is known by {good} of its tags")
                self.view, self._used = view, frozenset(tags.keys() - off.keys())
                self._tell_off(off, now)
        if self.view is None:
            obstacle = obstacle or (
                f"its tags {_names(tags)} do not lie as planned: compare each with the plan, and see whether this is "
                "the picture of the camera above the floor"
            )
            self._troubles.notice("floor", f"where the floor is in the picture is unknown: {obstacle}", now)

    def _obstacle(self, tags: Mapping[int, Floats]) -> str:
        """Why the floor cannot be measured by these, "" if it can."""
        missing = self._places.keys() - tags.keys()
        if not tags:
            return (
                f"none of its tags ({_names(self._places)}) is seen: look at the camera's picture for its direction, "
                "sharpness and light"
            )
        middles = np.array([self._places[number].mean(axis=0) for number in tags])
        across = np.linalg.svd(middles - middles.mean(axis=0), full_matrices=False)[2][-1]
        if len(tags) > 2 and np.ptp(middles @ across) < SPREAD:
            return f"those of its tags that are seen, {_names(tags)}, lie in a line: uncover one of {_names(missing)}"
        if len(tags) < LEAST:
            return f"of its tags only {_names(tags)} can be seen, of {LEAST} that are needed: uncover {_names(missing)}"
        return ""

    def _fit(self, tags: Mapping[int, Floats], size: Size) -> tuple[View | None, dict[int, float]]:
        """The view by all tags that fit together, and how far off the others are."""
        used = dict(tags)
        while True:
            view = self._solve(used, size)
            if view and self._worst(view, used) <= OFF and self._are_tags(view, used):
                far = self._far(view, tags)
                return view, {number: miss for number, miss in far.items() if not miss <= OFF}
            if len(tags) - len(used) == MOST_OFF:
                return None, {}
            # one tag that lies wrong bends the view towards itself: it is the one without which the others fit best
            without = [{one: used[one] for one in used if one != left_out} for left_out in used]
            without = [fewer for fewer in without if not self._obstacle(fewer)]
            if not without:
                return None, {}
            used = min(without, key=lambda fewer: self._worst(self._solve(fewer, size), fewer))

    def _solve(self, tags: Mapping[int, Floats], size: Size) -> View | None:
        try:
            return View.solve(size, tags, self._places, self._camera_height)
        except np.linalg.LinAlgError:  # no camera sees a floor so
            return None

    def _worst(self, view: View | None, tags: Mapping[int, Floats]) -> float:
        if view is None:
            return np.inf
        return max(np.inf if np.isnan(miss) else miss for miss in self._far(view, tags).values())

    def _far(self, view: View, tags: Mapping[int, Floats]) -> dict[int, float]:
        """How many m each tag is from its place; NaN for one that the view does not show at all."""
        if not tags:
            return {}
        found, places = self._corners(view, tags)
        misses = np.linalg.norm(found.mean(axis=1) - places.mean(axis=1), axis=1)
        return dict(zip(tags, misses.tolist(), strict=True))

    def _are_tags(self, view: View, tags: Mapping[int, Floats]) -> bool:
        """Whether most of them have the size and direction of a tag: a view can bring a few from anywhere to their
        places, but not their corners, too."""
        found, places = (each - each.mean(axis=1, keepdims=True) for each in self._corners(view, tags))
        return bool(np.median(np.linalg.norm(found - places, axis=2).max(axis=1)) <= UNLIKE)

    def _corners(self, view: View, tags: Mapping[int, Floats]) -> tuple[Floats, Floats]:
        """Where the tags' corners are by that view, and where they should be: n x 4 x 2 m."""
        found = view.places(np.concatenate([tags[number] for number in tags])).reshape(-1, 4, 2)
        return found, np.array([self._places[number] for number in tags])

    def _tell_off(self, off: Mapping[int, float], now: float) -> None:
        for number, miss in off.items():
            where = f"{miss * 100:.0f} cm" if miss < 1 else "far"
            text = f"floor tag {number} lies {where} from its place: put it back"
            self._troubles.notice(("off", number), text, now)


def corners_of(tag: TagPose) -> Floats:
    """Of a floor tag, 4 x 2 m: as printed the lower left, lower right, upper right, upper left one."""
    up = np.array([np.cos(tag.heading), np.sin(tag.heading)]) * FLOOR_TAG_SIZE / 2
    right = np.array([up[1], -up[0]])
    corners: Floats = np.array([tag.x, tag.y]) + np.array([-right - up, right - up, right + up, up - right])
    return corners


def _names(numbers: Iterable[int]) -> str:
    return ", ".join(str(number) for number in sorted(numbers))
