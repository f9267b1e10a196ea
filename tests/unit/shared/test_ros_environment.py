import pytest

from laser_bot_battle.ros_environment import ros_environment


def test_the_address_of_this_machine_is_the_one_on_the_route_to_the_master() -> None:
    assert ros_environment({}, "http://127.0.0.1:11311") == {
        "ROS_MASTER_URI": "http://127.0.0.1:11311",
        "ROS_IP": "127.0.0.1",
    }


@pytest.mark.parametrize("variable", ["ROS_IP", "ROS_HOSTNAME"])
def test_an_address_that_is_set_is_kept(variable: str) -> None:
    assert "ROS_IP" not in ros_environment({variable: "10.1.2.3"}, "http://127.0.0.1:11311")


def test_a_master_whose_name_is_unknown_is_an_error_that_names_it() -> None:
    with pytest.raises(OSError, match=r"cannot reach the ROS master at nowhere\.invalid"):
        ros_environment({}, "http://nowhere.invalid:11311")
