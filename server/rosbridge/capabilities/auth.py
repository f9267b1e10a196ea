"""auth: a client says who it is, whatever cookie it has (rosbridge protocol 1 `auth`; fields as roslib sends them).

{"op": "auth", "client": name, "mac": secret}: a player gives name and session token, or the ticket that a page gets
from GET /session; an operator gives "operator" and the operator's token. The further fields of the protocol (dest,
rand, t, level, end) have no meaning here.
"""

import logging
from collections.abc import Mapping

from server.rosbridge.capabilities.capability import Capability, Handler
from server.rosbridge.context import SIGN_UP_GRACE, Claim
from server.rosbridge.effects import Effect, Log
from server.rosbridge.gate import OPERATOR
from server.rosbridge.wire import Request, RequestError

MAX_SECRET = 1000  # characters


class Auth(Capability):
    def handlers(self) -> Mapping[str, Handler]:
        return {"auth": self.auth}

    def auth(self, request: Request, now: float) -> list[Effect]:
        name, secret = request.text("client"), request.text("mac")
        if len(secret) > MAX_SECRET:
            raise RequestError(f"the field 'mac' has more than {MAX_SECRET} characters")
        self.client.claim = Claim(name, secret, request.id, now + SIGN_UP_GRACE, may_be_operator=name == "operator")
        return self.updated(now)

    def updated(self, now: float) -> list[Effect]:
        client, claim = self.client, self.client.claim
        if claim is None:
            return []
        effects, reason = list[Effect](), "no player has this name and this token"
        # a player may be called operator, too
        identity = client.gate.proven(claim.name, claim.secret)
        if identity is None and claim.may_be_operator:
            try:
                is_operator = client.gate.is_operator_token(claim.secret, client.address, now)
            except RequestError as error:  # its turn may come while the claim waits
                reason = str(error)
            else:
                client.claim = claim._replace(may_be_operator=False)
                if is_operator:
                    identity = OPERATOR
                else:
                    text = f"wrong operator token from {client.address}"
                    effects = client.log(Log(logging.WARNING, text), now)
        if identity is not None:
            client.claim, client.identity = None, identity
        elif now >= claim.until:
            client.claim = None
            effects += client.report("error", reason, now, claim.id)
        return effects
