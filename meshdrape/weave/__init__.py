"""The fabric, its generator fibres, the net and what is measured on it."""

from meshdrape.weave.drape import drape
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.net import Net
from meshdrape.weave.status import NodeStatus

__all__ = ["Fabric", "Net", "NodeStatus", "drape"]
