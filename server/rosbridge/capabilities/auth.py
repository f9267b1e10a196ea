"""auth: a client says who it is, whatever cookie it has (rosbridge protocol 1 `auth`; fields as roslib sends them).

{"op": "auth", "client": name, "mac": secret}: a player gives name and session token, or the ticket that a page gets
from GET /session; an operator gives "operator" and the operator's token. The further fields of the protocol (dest,
rand, t, level, end) have no meaning here.
"""

import logging
from collections.abc import Mapping

from server.access.identity import MAX_SECRET, Claim
from server.rosbridge.capabilities.capability import Capability, Handler
from server.rosbridge.effects import Effect, Log
from server.websocket.requests import Request


class Auth(Capability):
    def handlers(self) -> Mapping[str, Handler]:
        return {"auth": self.auth}

    def auth(self, request: Request, now: float) -> list[Effect]:
        self.client.claim = Claim(request.text("client"), request.text("mac", MAX_SECRET), now, request.id)
        return self.updated(now)

    def updated(self, now: float) -> list[Effect]:
        client, claim = self.client, self.client.claim
        if claim is None:
            return []
        verdict = claim.judge(client.gate, client.address, now)
        effects = client.log(Log(logging.WARNING, verdict.warning), now) if verdict.warning else []
        if verdict.identity is not None:
            client.claim, client.identity = None, verdict.identity
        elif verdict.refusal:
            client.claim = None
            effects += client.report("error", verdict.refusal, now, claim.request)
        return effects
