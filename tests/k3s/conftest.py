"""The overlays of k3s/, built by kubectl; no cluster and no engine is needed."""

from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from tests.support.manifests import OVERLAYS, Manifests, overlay
from tests.support.programs import ROOT

Customize = Callable[..., Manifests]


@pytest.fixture(params=OVERLAYS)
def manifests(request: pytest.FixtureRequest) -> Manifests:
    """Each overlay in turn."""
    return overlay(request.param)


@pytest.fixture
def customize(tmp_path: Path) -> Customize:
    """Build an operator's own kustomization: its fields, over one of ours and with some of our components."""

    def build(base: str, *components: str, **fields: object) -> Manifests:
        # kustomize takes relative paths only
        up = Path(*[".."] * (len(tmp_path.parts) - 1)) / ROOT.relative_to("/") / "k3s"
        content = {
            "resources": [str(up / "overlays" / base)],
            "components": [str(up / "components" / name) for name in components],
            **fields,
        }
        (tmp_path / "kustomization.yaml").write_text(yaml.safe_dump(content))
        return Manifests(tmp_path)

    return build
