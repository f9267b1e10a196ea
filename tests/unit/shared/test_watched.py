"""Visitors who want to know how a program is."""

import socket

import pytest
import requests

from laser_bot_battle.names import WATCHED
from laser_bot_battle.watched import VISITORS, Owner, watched
from tests.support.polling import LATEST, until
from tests.support.ports import free_port


def test_those_who_ask_nothing_take_only_so_many_threads_and_leave_room_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("laser_bot_battle.watched._Visitor.timeout", LATEST)  # or the first may be gone too soon
    port = free_port()
    with watched(WATCHED[0], ("127.0.0.1", port), Owner(lambda: [], lambda: "")):
        silent = [socket.create_connection(("127.0.0.1", port), LATEST) for _ in range(VISITORS)]
        with socket.create_connection(("127.0.0.1", port), LATEST) as refused:
            assert refused.recv(1) == b""
        for visitor in silent:
            visitor.close()

        def is_answered() -> bool:
            try:
                return requests.get(f"http://127.0.0.1:{port}/readyz", timeout=LATEST).text == "ok\n"
            except requests.ConnectionError:
                return False

        until(is_answered)
