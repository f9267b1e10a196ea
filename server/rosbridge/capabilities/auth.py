"""auth: a client without a cookie says who it is (rosbridge protocol 1 `auth`; fields as roslib sends them).

{"op": "auth", "client": name, "mac": token}: a player gives name and session token, an operator "operator" and the
operator's token. The further fields of the protocol (dest, rand, t, level, end) have no meaning here.
"""

import hmac
from collections.abc import Mapping

from server.rosbridge.capabilities.capability import Family, Handler
from server.rosbridge.effects import Effect
from server.rosbridge.gate import OPERATOR, PATIENCE, Claim, session_identity
from server.rosbridge.wire import Request


class Auth(Family):
    def handlers(self) -> Mapping[str, Handler]:
        return {"auth": self.auth}

    def auth(self, request: Request, now: float) -> list[Effect]:
        name, token = request.text("client"), request.text("mac")
        # a player may bear this name too: a token that is not the operator's may still be the player's
        if name == "operator" and self.session.gate.is_operator_token(token):
            self.session.claim, self.session.identity = None, OPERATOR
            return []
        self.session.claim = Claim(name, session_identity(token), request.id, now + PATIENCE)
        return self.updated(now)

    def updated(self, now: float) -> list[Effect]:
        claim = self.session.claim
        if claim is None:
            return []
        player = self.session.gate.player(claim.who)
        if player is not None and hmac.compare_digest(player.name.encode(), claim.name.encode(errors="replace")):
            self.session.identity = claim.who
        elif player is None and now < claim.until:
            return []
        else:
            self.session.claim = None
            return self.session.report("error", "nobody of this name has this token", now, claim.id)
        self.session.claim = None
        return []
