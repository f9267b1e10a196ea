from robot.serial.dead_man import DeadMan

NEUTRAL = b"\0\0\0"
FORWARD = b"\x01\0\0"


def test_neutral_is_due_300_ms_after_the_last_command_and_only_once() -> None:
    dead_man = DeadMan(NEUTRAL)
    dead_man.command(FORWARD, 10.0)
    assert dead_man.deadline == 10.3
    assert not dead_man.expired(10.29)
    assert dead_man.expired(10.31)
    assert not dead_man.expired(20.0)


def test_each_command_puts_it_off() -> None:
    dead_man = DeadMan(NEUTRAL)
    for tick in range(40):
        dead_man.command(FORWARD, tick * 0.25)
        assert not dead_man.expired(tick * 0.25 + 0.24)
    assert dead_man.expired(39 * 0.25 + 0.31)


def test_a_neutral_robot_is_left_alone() -> None:
    dead_man = DeadMan(NEUTRAL)
    assert not dead_man.expired(100.0)
    dead_man.command(FORWARD, 200.0)
    dead_man.command(NEUTRAL, 200.1)
    assert dead_man.deadline is None
    assert not dead_man.expired(300.0)


def test_shooting_alone_is_not_neutral() -> None:
    dead_man = DeadMan(NEUTRAL)
    dead_man.command(b"\0\0\x01", 0.0)
    assert dead_man.expired(0.31)
