"""Draping of woven cloth over CAD and mesh moulds as a pin-jointed net whose every edge is an exact geodesic.

The names below are the public interface; they are imported on first use, so that ``import meshdrape`` is instant.
Lengths are millimetres and angles radians throughout.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from meshdrape.errors import MeshdrapeError
    from meshdrape.geodesic import geodesic_distance
    from meshdrape.mould import Mould, read_mould
    from meshdrape.output import read_net, write_ply
    from meshdrape.study import Convergence, Forecast, forecast, refine
    from meshdrape.weave import Audit, Fabric, Measures, Net, NodeStatus, audit, drape, measure

__version__ = "0.1.0"

_HOME = {
    "Audit": "weave",
    "Convergence": "study",
    "Fabric": "weave",
    "Forecast": "study",
    "Measures": "weave",
    "MeshdrapeError": "errors",
    "Mould": "mould",
    "Net": "weave",
    "NodeStatus": "weave",
    "audit": "weave",
    "drape": "weave",
    "forecast": "study",
    "geodesic_distance": "geodesic",
    "measure": "weave",
    "read_mould": "mould",
    "read_net": "output",
    "refine": "study",
    "write_ply": "output",
}

__all__ = [
    "Audit",
    "Convergence",
    "Fabric",
    "Forecast",
    "Measures",
    "MeshdrapeError",
    "Mould",
    "Net",
    "NodeStatus",
    "audit",
    "drape",
    "forecast",
    "geodesic_distance",
    "measure",
    "read_mould",
    "read_net",
    "refine",
    "write_ply",
]


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(importlib.import_module(f"meshdrape.{_HOME[name]}"), name)
    msg = f"module 'meshdrape' has no attribute {name!r}"
    raise AttributeError(msg)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
