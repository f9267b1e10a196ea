"""For catkin, see CMakeLists.txt."""

from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(
    **generate_distutils_setup(
        packages=["laser_bot_battle"],
        package_dir={"": "src"},
        package_data={"laser_bot_battle": ["floors/*.json"]},
    )
)
