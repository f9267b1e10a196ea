"""The overlays of k3s/, built by kubectl; no cluster and no engine is needed."""

from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path

import pytest
from kubernetes_validate import utils

from tests.support.manifests import OVERLAYS, Manifests, customized, overlay

Customize = Callable[..., Manifests]


@pytest.fixture(scope="session", autouse=True)
def read_each_schema_once() -> Iterator[None]:
    """kubernetes-validate reads all definitions anew for each object, which takes longer than to look at it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(utils, "schema_contents", cache(utils.schema_contents))
        yield


@pytest.fixture(params=OVERLAYS)
def manifests(request: pytest.FixtureRequest) -> Manifests:
    """Each overlay in turn."""
    return overlay(request.param)


@pytest.fixture
def customize(tmp_path: Path) -> Customize:
    """Build an operator's own kustomization: its fields, over one of ours and with some of our components."""
    return partial(customized, tmp_path)
