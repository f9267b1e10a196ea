"""What was played: pages for people, JSON and CSV for programs (docs/results.md).

Nobody has to sign in. A page or file says what is wrong with a request, or that the database is away, in its own
format: the game does not depend on it.
"""

import csv
import io
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, date, datetime, timedelta
from itertools import groupby
from typing import Any

from flask import Blueprint, Response, make_response, render_template, request
from jinja2.utils import htmlsafe_json_dumps

from server.pages.chart import draw
from server.store.course import Course
from server.store.csv_safety import harmless
from server.store.database import AwayError
from server.store.honours import Honour, honours
from server.store.results import Battle, BusyError, Fighter, Results, Standing
from server.web.words import t, text

SIZE, MAX_SIZE = 25, 500  # battles on a page
_NUMBER = re.compile(r"[1-9][0-9]{0,5}")
_DAY = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2}")


class Refused(Exception):  # noqa: N818 - the visitor's error, not ours
    """The request cannot be answered; the words with this key, `values` in their places, say why."""

    def __init__(self, code: int, key: str, **values: str | int) -> None:
        super().__init__(key)
        self.code, self.key, self.values = code, key, values


@dataclass(frozen=True, slots=True)
class Page:
    """A part of the list."""

    battles: list[Battle]
    number: int
    pages: int
    size: int
    total: int


@dataclass(frozen=True, slots=True)
class Leaderboard:
    day: str  # like 2025-03-01, or "all"
    standings: list[Standing]
    honours: list[Honour]  # of a day


def create_results(results: Results) -> Blueprint:
    """The routes, as a Flask blueprint named `results`."""
    pages = Blueprint("results", __name__)
    pages.add_app_template_filter(duration)
    pages.add_app_template_filter(moment)
    pages.add_app_template_filter(by_day)
    pages.add_app_template_filter(figures)
    pages.add_app_template_filter(percent)
    _add_battles(pages, results)
    _add_leaderboard(pages, results)

    @pages.after_request
    def let_visitors_keep(response: Response) -> Response:
        """They ask each time whether it is still true."""
        response.headers["Cache-Control"] = "no-cache"
        return response

    @pages.errorhandler(Refused)
    def refuse(error: Refused) -> Response:
        return _explain(error.code, error.key, error.values)

    @pages.errorhandler(AwayError)
    def away(_: AwayError) -> Response:
        return _explain(503, "results.away", {})

    @pages.errorhandler(BusyError)
    def busy(_: BusyError) -> Response:
        response = _explain(503, "results.busy", {})
        response.headers["Retry-After"] = "2"
        return response

    return pages


def _add_battles(pages: Blueprint, results: Results) -> None:
    @pages.get("/results")
    def battles() -> str:
        return render_template("results.html", page=_page(results))

    @pages.get("/results.json")
    def battles_json() -> Response:
        page = _page(results)
        return _json(
            battles=[_battle_fields(battle) for battle in page.battles],
            page=page.number,
            pages=page.pages,
            size=page.size,
            total=page.total,
        )

    @pages.get("/results.csv")
    def battles_csv() -> Response:
        head = "id,number,began,seconds,counts,cause,place,name,robot,life,left,hits_taken,hits_given,played"
        head += ",team,shots,kills,accuracy"
        return csv_file("laserbot-results.csv", head, _battle_rows(_page(results).battles))

    @pages.get("/results/<battle>")
    def battle(battle: str) -> str:
        found, courses = _find(results, battle)
        by_place = {fighter.name: place for place, fighter in enumerate(found.fighters)}
        courses.sort(key=lambda course: by_place.get(course.name, len(by_place)))
        chart = draw(courses, _length(found, courses))
        return render_template(
            "results_battle.html",
            battle=found,
            chart=chart,
            moments=_moments(courses),
            has_track=results.has_track(found.id),
        )

    @pages.get("/results/<battle>.json")
    def battle_json(battle: str) -> Response:
        found, courses = _find(results, battle)
        return _json(
            **_battle_fields(found),
            timeline=_moments(courses),
            places=results.places(found.id),
            effects=results.effects(found.id),
            points=results.points(found.id),
            track=results.track(found.id),
        )


def _add_leaderboard(pages: Blueprint, results: Results) -> None:
    @pages.get("/results/leaderboard")
    def leaderboard() -> str:
        board = _leaderboard(results)
        return render_template("results_leaderboard.html", board=board, today=_today())

    @pages.get("/results/leaderboard.json")
    def leaderboard_json() -> Response:
        board = _leaderboard(results)
        return _json(
            day=board.day,
            players=[_standing_fields(standing) for standing in board.standings],
            honours=[{"kind": one.kind, "name": one.name, "value": one.value} for one in board.honours],
        )

    @pages.get("/results/leaderboard.csv")
    def leaderboard_csv() -> Response:
        board = _leaderboard(results)
        head = "place,name,battles,wins,hits_taken,hits_given,seconds,shots,kills,accuracy"
        return csv_file(
            f"laserbot-leaderboard-{board.day}.csv", head, (_standing_fields(one).values() for one in board.standings)
        )


# what is asked


def _page(results: Results) -> Page:
    number, size = _number("page", 1, 999_999), _number("size", SIZE, MAX_SIZE)
    battles, total = results.battles(number, size)
    pages = max(1, -(-total // size))
    if number > pages:
        raise Refused(404, "results.no_page", number=number, last=pages)
    return Page(battles, number, pages, size, total)


def _number(name: str, default: int, highest: int) -> int:
    given = request.args.get(name, str(default))
    if not _NUMBER.fullmatch(given) or int(given) > highest:
        raise Refused(400, "results.bad_number", name=name, highest=highest)
    return int(given)


def _find(results: Results, battle: str) -> tuple[Battle, list[Course]]:
    found = results.battle(int(battle)) if _NUMBER.fullmatch(battle) else None
    if found is None:
        raise Refused(404, "results.no_battle")
    return found


def _leaderboard(results: Results) -> Leaderboard:
    given = request.args.get("day") or "all"
    if given == "all":
        return Leaderboard(given, results.standings(), [])
    try:
        if not _DAY.fullmatch(given):
            raise ValueError
        day = date.fromisoformat(given)
        begin, end = (datetime(one.year, one.month, one.day).timestamp() for one in (day, day + timedelta(days=1)))
    except (ValueError, OverflowError, OSError):
        raise Refused(400, "results.bad_day") from None
    standings = results.leaderboard(begin, end)
    return Leaderboard(given, standings, honours(standings, results.winners(begin, end)))


# what is answered


def _battle_fields(battle: Battle) -> dict[str, Any]:
    return {
        "id": battle.id,
        "number": battle.number,
        "arena": battle.arena,
        "began": battle.began,
        "seconds": battle.seconds,
        "counts": battle.counts,
        "running": battle.running,
        "cause": battle.cause,
        "fighters": [_fighter_fields(fighter) for fighter in battle.fighters],
    }


def _fighter_fields(fighter: Fighter) -> dict[str, Any]:
    return {
        "place": fighter.place,
        "name": fighter.name,
        "robot": fighter.robot,
        "life": fighter.life,
        "left": fighter.left,
        "hits_taken": fighter.hits,
        "hits_given": fighter.given,
        "seconds": fighter.seconds,
        "team": fighter.team,
        "shots": fighter.shots,
        "kills": fighter.kills,
        "accuracy": fighter.accuracy,
    }


def _standing_fields(standing: Standing) -> dict[str, Any]:
    return {
        "place": standing.place,
        "name": standing.name,
        "battles": standing.battles,
        "wins": standing.wins,
        "hits_taken": standing.hits,
        "hits_given": standing.given,
        "seconds": standing.seconds,
        "shots": standing.shots,
        "kills": standing.kills,
        "accuracy": standing.accuracy,
    }


def _battle_rows(battles: Iterable[Battle]) -> Iterable[Iterable[object]]:
    for battle in battles:
        began = datetime.fromtimestamp(battle.began).astimezone().isoformat(timespec="seconds")
        for fighter in battle.fighters:
            fields = _fighter_fields(fighter).values()
            yield battle.id, battle.number, began, battle.seconds, battle.counts, battle.cause, *fields


def _moments(courses: Iterable[Course]) -> list[dict[str, Any]]:
    """What happened, in its order; `at` in s since the battle began."""
    moments: list[dict[str, Any]] = []
    for course in courses:
        if course.joined > 0:
            first = {"at": course.joined, "name": course.name, "what": "joined", "life": course.first, "by": None}
            moments.append(first)
        moments += [
            {"at": at, "name": course.name, "what": what, "life": life, "by": by or None}
            for at, what, life, by in course.changes
        ]
        if course.left is not None:
            moments.append({"at": course.left, "name": course.name, "what": "left", "life": course.life, "by": None})
    return sorted(moments, key=lambda moment: float(moment["at"]))


def _length(battle: Battle, courses: Iterable[Course]) -> float:
    """How long the battle lasted, or has lasted."""
    if battle.seconds is not None:
        return battle.seconds
    if battle.so_far is not None:
        return battle.so_far
    return max((change.at for course in courses for change in course.changes), default=0.0)


def _json(**content: Any) -> Response:
    return make_response(
        str(htmlsafe_json_dumps(content, sort_keys=True)), 200, {"Content-Type": "application/json; charset=utf-8"}
    )


def csv_file(file: str, head: str, rows: Iterable[Iterable[object]]) -> Response:
    """UTF-8 with the mark by which spreadsheets know it."""
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(head.split(","))
    for row in rows:
        writer.writerow([_cell(value) for value in row])
    return make_response(
        text.getvalue().encode("utf-8-sig"),
        200,
        {"Content-Type": "text/csv; charset=utf-8", "Content-Disposition": f'attachment; filename="{file}"'},
    )


def _cell(value: object) -> object:
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, float):
        return round(value, 2)
    return harmless(value)


def _explain(code: int, key: str, values: Mapping[str, str | int]) -> Response:
    """A page in the visitor's language; a file for programs is English."""
    if request.path.endswith(".json"):
        answer = _json(error=text("en", key, **values))
    elif request.path.endswith(".csv"):
        answer = make_response(f"{text('en', key, **values)}\n", code, {"Content-Type": "text/plain; charset=utf-8"})
    else:
        answer = make_response(render_template("results_error.html", code=code, text=t(key, **values)))
    answer.status_code = code
    return answer


# for people


def duration(seconds: float | None) -> str:
    """Like 4:05, or 1:02:03; - for none."""
    if seconds is None:
        return "-"
    minutes, second = divmod(round(seconds), 60)
    hours, minute = divmod(minutes, 60)
    return f"{hours}:{minute:02}:{second:02}" if hours else f"{minute}:{second:02}"


def figures(fighter: Fighter) -> str:
    """How a fighter fared, as short as it goes, in the reader's language."""
    told = [t("podium.life", life=fighter.life)]
    if fighter.given is not None:
        hits = t("results.hits", n=fighter.given)
        told.append(hits if fighter.accuracy is None else f"{hits} ({percent(fighter.accuracy)})")
    if fighter.kills:
        told.append(t("podium.kills", n=fighter.kills))
    return ", ".join(told)


def percent(share: float) -> str:
    return t("results.percent", n=round(100 * share))


def moment(unix: float) -> datetime:
    """In UTC; the page's script tells it in the reader's time zone."""
    return datetime.fromtimestamp(round(unix), UTC)


def by_day(battles: Iterable[Battle]) -> Iterable[tuple[date, list[Battle]]]:
    """The battles of each day by the server's time zone, in the order in which they come."""
    for day, ones in groupby(battles, lambda battle: date.fromtimestamp(battle.began)):
        yield day, list(ones)


def _today() -> str:
    return date.today().isoformat()
