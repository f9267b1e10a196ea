"""Programs that begin anew on another floor notice that its file has changed."""

import asyncio
import json
from pathlib import Path

import pytest

from laser_bot_battle import floor_watch
from laser_bot_battle.floor import read_floor
from laser_bot_battle.floor_watch import another_floor

FLOOR = {"width": 4, "height": 2, "starts": [[1, 1]]}


@pytest.fixture(autouse=True)
def eager(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(floor_watch, "PERIOD", 0.001)


def test_another_floor_ends_the_wait_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "hall.json"
    path.write_text(json.dumps(FLOOR))

    async def story() -> None:
        waiting = asyncio.create_task(another_floor(str(path), read_floor(str(path))))
        for same in (json.dumps(FLOOR, indent=1), "half a fi", json.dumps({**FLOOR, "width": 400}), None):
            path.unlink()
            if same is not None:
                path.write_text(same)
            done, _ = await asyncio.wait([waiting], timeout=0.05)
            assert not done, same
        path.write_text(json.dumps({**FLOOR, "width": 3}))
        await asyncio.wait_for(waiting, 10)

    asyncio.run(story())
