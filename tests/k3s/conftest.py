"""The overlays of k3s/, built by kubectl; no cluster and no engine is needed."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from tests.support.manifests import OVERLAYS, Manifests, customized, overlay

Customize = Callable[..., Manifests]


@pytest.fixture(params=OVERLAYS)
def manifests(request: pytest.FixtureRequest) -> Manifests:
    """Each overlay in turn."""
    return overlay(request.param)


@pytest.fixture
def customize(tmp_path: Path) -> Customize:
    """Build an operator's own kustomization: its fields, over one of ours and with some of our components."""
    return partial(customized, tmp_path)
