"""docs/operator-api.md and docs/operator.md against the operators' routes and bounds."""

from flask import Flask

from laser_bot_battle.variables import SHORTEST_TOKEN
from server.access import attempts
from server.game import desk
from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.robot_health import RobotsHealth
from server.game.rules import Rules
from server.store.database import Database
from server.store.log import EventLog
from server.web.bots import BotsProgram
from server.web.operator import create_operator
from server.web.operator_access import Access
from server.web.operator_api import create_operator_api
from server.web.settings import Settings
from tests.support.documents import page, table

PAGE, GUIDE = page("operator-api.md"), page("operator.md")


def test_the_page_has_every_route_and_no_other() -> None:
    settings = Settings.from_env({"LASERBOT_OPERATOR_TOKEN": "the operators' token"})
    access, database = Access(settings.operator_token), Database(settings.database)
    app = Flask(__name__, static_folder=None)
    app.register_blueprint(create_operator(access))
    app.register_blueprint(
        create_operator_api(
            GameLoop(Referee(Rules())),
            settings,
            access,
            database,
            EventLog(database),
            health=RobotsHealth(),
            bots=BotsProgram(),
            overhead=list,
            identify=lambda _: True,
            ask_audience=lambda _: None,
        )
    )
    methods = {"GET", "POST", "PUT", "DELETE", "PATCH"}
    routes = {(method, rule.rule) for rule in app.url_map.iter_rules() for method in (rule.methods or set()) & methods}
    rows = table(PAGE, "Routes")
    assert {(row["method"], path) for row in rows for path in row["path"].split(", ")} == routes


def test_the_bounds_are_those_of_the_code() -> None:
    for bound in (
        f"1 to {desk.MAX_ADDED}",
        f"up to {desk.MAX_WORDS}",
        f"up to {desk.MAX_MESSAGE} characters",
        f"up to {desk.MAX_PRESET} characters",
        f"at most {desk.MAX_PRESETS} times",
        f"at least {SHORTEST_TOKEN} characters",
        f"{attempts.FREE} at once",
    ):
        assert bound in PAGE + GUIDE
