"""What is decided in a tournament; see server.game.events."""

from dataclasses import dataclass

from server.game.people import Name, Words, signature


@dataclass(frozen=True, slots=True)
class TournamentOpened:
    """It takes the place of the last one; see server.game.tournament.Tournament for the fields."""

    title: Words
    mode: str  # a server.game.draw.Kind
    names: tuple[Name, ...]
    best_of: int
    third: bool
    groups: int
    patience: float
    by: Name

    def __str__(self) -> str:
        return f"the tournament {self.title} is open: {self.mode}, {len(self.names)} players{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class MatchCalled:
    """Its players, `names`, are to come to these robots and get ready."""

    match: int
    names: tuple[Name, ...]
    robots: tuple[int, ...]
    by: Name

    def __str__(self) -> str:
        who = " against ".join(f"{name} (robot {robot})" for name, robot in zip(self.names, self.robots, strict=True))
        return f"match {self.match} is called: {who}{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class GameWon:
    """The referee's result of a battle between the players of the match that was called."""

    match: int
    name: Name
    battle: int

    def __str__(self) -> str:
        return f"match {self.match}: {self.name} has won battle {self.battle}"


@dataclass(frozen=True, slots=True)
class NoShow:
    """Whoever was not there has lost the match."""

    match: int
    name: Name
    winner: Name
    by: Name = ""

    def __str__(self) -> str:
        return f"match {self.match}: {self.name} was not there, so {self.winner} has won{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class MatchCorrected:
    """An operator decides who has won. Matches that get other players by that are to be played again."""

    match: int
    winner: Name
    reason: Words
    by: Name

    def __str__(self) -> str:
        return f"match {self.match} corrected: {self.winner} has won, since: {self.reason}{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class TournamentClosed:
    """Nothing of it is played any more."""

    by: Name

    def __str__(self) -> str:
        return f"the tournament is closed{signature(self.by)}"


TournamentEvent = TournamentOpened | MatchCalled | GameWon | NoShow | MatchCorrected | TournamentClosed
