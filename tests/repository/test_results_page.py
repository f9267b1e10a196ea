"""docs/results.md and the routes themselves."""

from server.pages.app import create_pages
from server.pages.audience import Audience
from server.pages.results import MAX_SIZE, SIZE
from server.store.results import MAX_PLAYERS, Results
from server.web.settings import Settings
from tests.support.documents import page, table


def test_the_page_lists_every_route() -> None:
    settings = Settings.from_env({})
    app = create_pages(settings, Results(settings.database), Audience())
    routes = {rule.rule.replace("<battle>", "ID") for rule in app.url_map.iter_rules() if "results" in rule.rule}
    assert {row["address"] for row in table(page("results.md"), "Pages and files")} == routes


def test_the_page_names_the_bounds() -> None:
    text = page("results.md")
    assert f"1 to {MAX_SIZE}; {SIZE}" in text
    assert f"It has the first {MAX_PLAYERS}." in text
