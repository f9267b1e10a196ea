"""The tournament, for everybody: a page, JSON and CSV (docs/results.md)."""

from typing import Any

from flask import Blueprint, Response, jsonify, render_template

from server.pages.results import csv_file
from server.store.results import Results
from server.web.words import t

_COLUMNS = "match,group,round,third_place,player_1,player_2,wins_1,wins_2,winner,how"


def add_tournament(pages: Blueprint, results: Results, arena: str) -> None:
    """Its routes, for the blueprint of the results, which says when the database is away."""
    pages.add_app_template_filter(stage)
    pages.add_app_template_filter(source)

    @pages.get("/tournament")
    def tournament() -> str:
        return render_template("tournament.html", tournament=results.tournament(arena))

    @pages.get("/tournament.json")
    def tournament_json() -> Response:
        return jsonify(tournament=results.tournament(arena))

    @pages.get("/tournament.csv")
    def tournament_csv() -> Response:
        found = results.tournament(arena)
        rows = [
            [*(match[field] for field in ("number", "group", "round", "third")),
             *match["players"], *match["wins"], match["winner"], match["how"]]
            for match in (found["matches"] if found else ())
        ]  # fmt: skip
        return csv_file("laserbot-tournament.csv", _COLUMNS, rows)


def stage(match: dict[str, Any]) -> str:
    """What kind of match it is, in the reader's language."""
    if match["group"]:
        return t("tournament.group", n=match["group"])
    if match["third"]:
        return t("tournament.third_place")
    return t(f"tournament.round_{match['round']}" if match["round"] <= 8 else "tournament.round", n=match["round"])


def source(side: dict[str, Any]) -> str:
    """Who will come, before it is known."""
    if side["what"] == "group":
        return t("tournament.from_group", n=side["number"], place=side["place"])
    return t(f"tournament.from_{side['what']}", n=side["number"])
