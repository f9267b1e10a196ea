"""auth: a client without a cookie says who it is (rosbridge protocol 1 `auth`; fields as roslib sends them).

{"op": "auth", "client": name, "mac": token}: a player gives name and session token, an operator "operator" and the
operator's token. The further fields of the protocol (dest, rand, t, level, end) have no meaning here.
"""

import hmac
from collections.abc import Mapping

from server.rosbridge.capabilities.capability import Capability, Handler
from server.rosbridge.context import SIGN_UP_GRACE, Claim
from server.rosbridge.effects import Effect
from server.rosbridge.gate import OPERATOR, session_identity
from server.rosbridge.wire import Request


class Auth(Capability):
    def handlers(self) -> Mapping[str, Handler]:
        return {"auth": self.auth}

    def auth(self, request: Request, now: float) -> list[Effect]:
        name, token = request.text("client"), request.text("mac")
        # a player may bear this name too: a token that is not the operator's may still be the player's
        if name == "operator" and self.client.gate.is_operator_token(token):
            self.client.claim, self.client.identity = None, OPERATOR
            return []
        self.client.claim = Claim(name, session_identity(token), request.id, now + SIGN_UP_GRACE)
        return self.updated(now)

    def updated(self, now: float) -> list[Effect]:
        claim = self.client.claim
        if claim is None:
            return []
        player = self.client.gate.player(claim.identity)
        if player is None and now < claim.until:
            return []
        self.client.claim = None
        if player is not None and hmac.compare_digest(player.name.encode(), claim.name.encode(errors="replace")):
            self.client.identity = claim.identity
            return []
        return self.client.report("error", "no player has this name and this token", now, claim.id)
