"""The tables of the database.

Several arenas may share a database server. Battles, fighters, tracks and what is forgotten are then everybody's; the
state, the robots' IDs and the events are each arena's own. An arena is "" where it shares nothing.
"""

from sqlalchemy import (
    JSON,
    Boolean,
    Column,
    Float,
    ForeignKey,
    Index,
    Integer,
    MetaData,
    String,
    Table,
    Text,
    UniqueConstraint,
    desc,
    false,
    text,
    true,
)

metadata = MetaData()


def _arena(is_key: bool = False) -> Column[str]:
    return Column("arena", String(64), primary_key=is_key, nullable=False, server_default="")


schema = Table("schema", metadata, Column("version", Integer, nullable=False))

# which named robot has which ID
robots = Table(
    "robots",
    metadata,
    Column("caller", String(255), primary_key=True),  # ROS name of its client
    Column("robot", Integer, nullable=False),
    _arena(is_key=True),
    UniqueConstraint("robot", "arena"),
)

_LEFT_OVER = text("ended IS NOT NULL AND NOT tallied")

battles = Table(
    "battles",
    metadata,
    Column("id", Integer, primary_key=True),
    Column(
        "number", Integer, nullable=False
    ),  # for people; begins anew when the game had to begin without the database
    Column("began", Float, nullable=False),  # Unix time in s, as all times here
    Column("ended", Float),
    Column("cause", Text),
    Column("result", JSON),  # list of Placing
    Column("counts", Boolean, nullable=False, server_default=true()),  # False: aborted, nobody has won
    _arena(),
    Column("tallied", Boolean, nullable=False, server_default=false()),  # is in the table of standings
    Index("battles_began", "began"),
    Index("battles_left_over", "id", postgresql_where=_LEFT_OVER, sqlite_where=_LEFT_OVER),
)

# who fought; made from the battle's events when it begins and again when it ends, see server.store.fighters
fighters = Table(
    "fighters",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("battle", Integer, ForeignKey("battles.id"), nullable=False, index=True),
    Column("name", String(64), nullable=False, index=True),
    Column("robot", Integer, nullable=False),
    Column("avatar", Integer, nullable=False),
    Column("place", Integer),  # None until the battle has ended
    Column("life", Integer, nullable=False),
    Column("left", Boolean, nullable=False, server_default=false()),  # was gone before the end
    Column("hits", Integer, nullable=False),  # taken
    Column("seconds", Float, nullable=False),  # until death, leaving or the end
    Column("team", Integer),  # 0: fought alone
    Column("shots", Integer),  # fired; None: nobody has counted
    Column("given", Integer),  # hits; None: of some hits of the battle nobody knows whose
    Column("kills", Integer),  # likewise
)

HITS_TAKEN = "hits * 1.0 / battles"  # in each battle on average

# what the battles that count come to for each player, see server.store.tally
standings = Table(
    "standings",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("name", String(64), nullable=False, unique=True),
    Column("battles", Integer, nullable=False),
    Column("wins", Integer, nullable=False),
    Column("hits", Integer, nullable=False),
    Column("seconds", Float, nullable=False),
    Column("shots", Integer),
    Column("given", Integer),
    Column("kills", Integer),
    Column("met", Integer),
    Column("aimed", Integer),
    Index("standings_order", desc("wins"), text(f"({HITS_TAKEN})"), "name"),  # of the leaderboard
)

events = Table(
    "events",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("at", Float, nullable=False),
    Column("battle", Integer, ForeignKey("battles.id"), index=True),  # the one that ran
    Column("kind", String(32), nullable=False),  # class in server.game.events
    Column("data", JSON, nullable=False),
    _arena(),
    Index("events_of_arena", "arena", "id"),
)

# where the robots were in a battle, in pieces of some seconds, see server.store.track
tracks = Table(
    "tracks",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("battle", Integer, ForeignKey("battles.id"), nullable=False, index=True),
    Column("data", JSON, nullable=False),
)

# the newest state of the game, one row for each arena
state = Table(
    "state",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("at", Float, nullable=False),
    Column("data", JSON, nullable=False),  # see server.game.persistence; and `clock`, see server.store.clocks
    _arena(),
    Index("state_of_arena", "arena", unique=True),
)

# players whose data were deleted, see server.store.forget
forgotten = Table(
    "forgotten",
    metadata,
    Column("id", Integer, primary_key=True),  # the number in the name that stands there now: "player 17"
    Column("at", Float, nullable=False),
    Column("digest", String(64)),  # SHA-256 (hex) of the name, until the servers that run have forgotten it, too
    Column("arenas", JSON),  # of the servers that may still remember it
)
