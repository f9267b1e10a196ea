"""A container engine as far as a card asks one."""

from typing import Any


class CardEngine:
    """Images, and containers with their bodies and states. An image's archive is the lines with its names."""

    def __init__(self) -> None:
        self.images: set[str] = set()
        self.containers: dict[str, Any] = {}
        self.changes: list[str] = []
        # these containers, or all of these images
        self.ill: set[str] = set()  # are never healthy
        self.restless: set[str] = set()  # end and start again all the time
        self.unreadable: set[str] = set()  # images whose archives the engine refuses
        self.torn: set[str] = set()  # images that it finds to be broken when it has begun to answer
        self.unsynced: set[str] = set()  # images that are not yet on the disk
        self.hollow: set[str] = set()  # images that a cut has left without their files
        self._starts = 0

    def sync(self) -> None:
        """What the disk lacks is on it."""
        self.unsynced.clear()

    def lose_power(self) -> None:
        self.hollow |= self.unsynced

    def lose_files(self) -> None:
        """Its folders are emptied."""
        for kept in (self.images, self.containers, self.unsynced, self.hollow):
            kept.clear()

    def ask(self, method: str, path: str, body: Any = None) -> tuple[int, Any]:
        if method != "GET":
            self.changes.append(f"{method} {path}")
        match method, path.partition("?")[0].strip("/").split("/"):
            case _, ["_ping"]:
                return 200, "OK"
            case _, ["images", *words]:
                return self._images(method, words, body)
            case _, ["containers", *words]:
                return self._containers(method, words, path.partition("=")[2], body)
        raise AssertionError(path)

    def _images(self, method: str, words: list[str], body: Any) -> tuple[int, Any]:
        match method, words:
            case "GET", ["json"]:
                return 200, [{"RepoTags": [image]} for image in sorted(self.images)] + [{"RepoTags": None}]
            case "GET", [image, "json"]:
                return (200, {}) if image in self.images else (404, {})
            case "POST", ["load"]:
                names = set(body.read().decode().split())
                if names & self.unreadable:
                    return 500, {"message": "invalid tar header"}
                if names & self.torn:
                    return 200, {"errorDetail": {"message": "unexpected EOF"}}
                self.images |= names
                self.unsynced |= names
            case "DELETE", [image]:
                if any(one["Config"].get("Image") == image for one in self.containers.values()):
                    return 409, {"message": "conflict"}
                self.images.remove(image)
            case other:
                raise AssertionError(other)
        return 200, {}

    def _containers(self, method: str, words: list[str], new: str, body: Any) -> tuple[int, Any]:
        match method, words:
            case "GET", ["json"]:
                found = self.containers.items()
                return 200, [{"Names": [f"/{name}"], "Labels": one["Config"]["Labels"]} for name, one in found]
            case "GET", [name, "json"]:
                return (200, self._told(name, self.containers[name])) if name in self.containers else (404, {})
            case "POST", ["create"]:
                if body["Image"] not in self.images:
                    return 404, {"message": "no such image"}
                self.containers[new] = {"Config": body, "State": {"Status": "created"}}
            case "POST", [name, "start"]:
                if self.containers[name]["Config"]["Image"] in self.hollow:
                    return 400, {"message": "exec: python3: no such file"}
                self._starts += 1
                self.containers[name]["State"] = {"Status": "running", "StartedAt": self._starts}
            case "DELETE", [name]:
                del self.containers[name]
            case other:
                raise AssertionError(other)
        return 200, {}

    def _told(self, name: str, container: Any) -> Any:
        names, state = {name, container["Config"].get("Image")}, container["State"]
        if names & self.restless:
            self._starts += 1
            state["StartedAt"] = self._starts
        is_running = state["Status"] == "running"
        health = {"Status": "healthy" if is_running and not names & self.ill else "unhealthy"}
        return {**container, "State": {"StartedAt": 0, **state, "Running": is_running, "Health": health}}
