"""docs/results.md and the routes themselves."""

from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.rules import Rules
from server.store.results import MAX_PLAYERS
from server.web.app import create_app
from server.web.results import MAX_SIZE, SIZE
from server.web.settings import Settings
from tests.support.documents import page, table


def test_the_page_lists_every_route() -> None:
    app = create_app(GameLoop(Referee(Rules())), Settings.from_env({}))
    routes = {rule.rule.replace("<battle>", "ID") for rule in app.url_map.iter_rules() if "results" in rule.rule}
    assert {row["address"] for row in table(page("results.md"), "Pages and files")} == routes


def test_the_page_names_the_bounds() -> None:
    text = page("results.md")
    assert f"1 to {MAX_SIZE}; {SIZE}" in text
    assert f"It has the first {MAX_PLAYERS}." in text
