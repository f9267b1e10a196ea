"""Imports within the programs go one way: no module imports itself by way of others, nor hides that from Python."""

import ast
import re
from collections.abc import Iterator
from graphlib import TopologicalSorter

from tests.support.programs import ROOT


def modules() -> dict[str, ast.Module]:
    """The syntax trees of all modules by name."""
    trees = {}
    for source, room in (
        (ROOT, "server"),
        (ROOT, "robot"),
        (ROOT, "sim"),
        (ROOT, "cards"),
        (ROOT / "laser_bot_battle/src", ""),
    ):
        for path in (source / room).rglob("*.py"):
            name = ".".join(path.relative_to(source).with_suffix("").parts).removesuffix(".__init__")
            trees[name] = ast.parse(path.read_text(), path)
    return trees


def imports(tree: ast.Module) -> Iterator[str]:
    """The names that a module imports: of modules, and of what is in them."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, "write absolute imports"
            yield str(node.module)
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_no_module_imports_itself_by_way_of_others() -> None:
    trees = modules()
    assert len(trees) > 50
    TopologicalSorter({name: set(imports(tree)) & trees.keys() for name, tree in trees.items()}).prepare()


def test_no_room_imports_itself_by_way_of_others() -> None:
    """A room is a folder of the server, or another program's folder as a whole."""
    arrows: dict[str, set[str]] = {}
    trees = modules()
    for name, tree in trees.items():
        arrows.setdefault(room(name), set()).update(room(other) for other in imports(tree) if other in trees)
    assert {"server.websocket", "server.access"} <= arrows["server.rosbridge"]
    TopologicalSorter({of: others - {of} for of, others in arrows.items()}).prepare()


def test_no_folder_of_the_pages_scripts_imports_itself_by_way_of_others() -> None:
    folder = ROOT / "server/static/js"
    arrows: dict[str, set[str]] = {}
    for path in folder.rglob("*.js"):
        found = re.findall(r"""from ["']\.\./(\w+)/""", path.read_text())
        arrows.setdefault(path.parent.name, set()).update(found)
    assert "common" in arrows["battle"]
    assert not arrows["common"]
    TopologicalSorter(arrows).prepare()


def room(module: str) -> str:
    parts = module.split(".")
    return ".".join(parts[:2]) if parts[0] == "server" else parts[0]


def test_no_import_is_for_the_type_checker_only() -> None:
    assert not [name for name, tree in modules().items() if "typing.TYPE_CHECKING" in imports(tree)]


def test_master_and_robot_share_nothing_but_the_contract_and_nobody_needs_the_simulation() -> None:
    forbidden = {"server": {"robot", "sim"}, "robot": {"server", "sim"}, "sim": {"server", "robot"}}
    forbidden["cards"] = {"server", "robot", "sim"}
    forbidden["laser_bot_battle"] = forbidden["tcpros"] = set(forbidden)
    for name, tree in modules().items():
        rooms = {imported.split(".")[0] for imported in imports(tree)}
        assert not rooms & forbidden[name.split(".")[0]], name
