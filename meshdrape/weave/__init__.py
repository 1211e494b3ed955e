"""The fabric, its generator fibres, the net, and what is measured on it."""

from meshdrape.weave.drape import drape
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.measures.cells import Measures, measure
from meshdrape.weave.measures.field import MouldField, read_off
from meshdrape.weave.net import Net
from meshdrape.weave.recheck.edges import Audit, audit
from meshdrape.weave.status import NodeStatus

__all__ = [
    "Audit",
    "Fabric",
    "Measures",
    "MouldField",
    "Net",
    "NodeStatus",
    "audit",
    "drape",
    "measure",
    "read_off",
]
