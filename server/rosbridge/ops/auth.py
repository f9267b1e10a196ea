"""auth: a client without a cookie says who it is (rosbridge protocol 1 `auth`; fields as roslib sends them).

{"op": "auth", "client": name, "mac": token}: a player gives name and session token, an operator "operator" and the
operator's token. The further fields of the protocol (dest, rand, t, level, end) have no meaning here.
"""

import hmac
from collections.abc import Mapping
from typing import NamedTuple

from server.rosbridge.effects import Effect
from server.rosbridge.gate import OPERATOR, Identity, session_identity
from server.rosbridge.ops.family import Family, Handler
from server.rosbridge.wire import Id, Request

# Who has just signed up may be quicker here than the news of it on /game_status.
PATIENCE = 2.0  # s


class Claim(NamedTuple):
    """A player's token that the gate does not know yet."""

    name: str
    who: Identity
    id: Id
    until: float


class Auth(Family):
    _claim: Claim | None = None

    def handlers(self) -> Mapping[str, Handler]:
        return {"auth": self.auth}

    def auth(self, request: Request, now: float) -> list[Effect]:
        name, token = request.text("client"), request.text("mac")
        # a player may bear this name too: a token that is not the operator's may still be the player's
        if name == "operator" and self.session.gate.is_operator_token(token):
            self._claim, self.session.identity = None, OPERATOR
            return []
        self._claim = Claim(name, session_identity(token), request.id, now + PATIENCE)
        return self.updated(now)

    def updated(self, now: float) -> list[Effect]:
        claim = self._claim
        if claim is None:
            return []
        player = self.session.gate.player(claim.who)
        if player is not None and hmac.compare_digest(player.name.encode(), claim.name.encode(errors="replace")):
            self.session.identity = claim.who
        elif player is None and now < claim.until:
            return []
        else:
            self._claim = None
            return self.session.report("error", "nobody of this name has this token", now, claim.id)
        self._claim = None
        return []
