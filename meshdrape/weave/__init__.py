"""The fabric, its generator fibres, the net, and what is measured on it."""

from meshdrape.weave.audit import Audit, audit
from meshdrape.weave.drape import drape
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.field import MouldField, read_off
from meshdrape.weave.measures import Measures, measure
from meshdrape.weave.net import Net
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
