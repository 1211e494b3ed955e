"""Design files of wing boxes, as the tables that TOML makes of them. Lengths in metres."""

from __future__ import annotations

from typing import Any

import numpy as np

from meshdrape.study.fold.design import Design, design_from
from meshdrape.study.fold.frame import Cloth, frame_of
from meshdrape.study.fold.lay import FoldDrape, lay
from meshdrape.study.fold.mould import cad_mould, ruled_mould

REAL = {
    "unit": "m",
    "span": 14.0,
    "chord": 3.0,
    "spar_height": 1.0,
    "spacing": 0.02,
    "locking_angle_deg": 7.0,
    "row_offset": 0.5,
    "wing": {"profile": "real"},
    "spar": {"deviation": "parabola", "c": 0.1},
    "start": {"first": "wing", "gamma_deg": 0.0},
}
# figure 4 of the study group report
FIGURE_4 = {
    **REAL,
    "span": 1.0,
    "chord": 1.5,
    "spar_height": 0.55,
    "wing": {"profile": "quadratic", "a": 0.2},
    "spar": {"profile": "quadratic", "a": 0.4},
}


def table(base: dict[str, Any] | None = None, **changes: Any) -> dict[str, Any]:
    """A design as TOML has it, with changes to its keys."""
    return {**(REAL if base is None else base), **changes}


def design(base: dict[str, Any] | None = None, **changes: Any) -> Design:
    return design_from(table(base, **changes))


def draped(of: Design, gamma: float | None = None, *, cad: bool = False) -> FoldDrape:
    """On the CAD mould, or on facets along the rulings."""
    frame = frame_of(of)
    gamma = frame.gamma(of.gamma) if gamma is None else gamma
    cloth = Cloth.of(frame, of.spacing, of.row_offset, gamma)
    mould = cad_mould(of, frame, cloth) if cad else ruled_mould(frame, cloth)
    return lay(cloth, mould, gamma, of.locking_angle)


def in_degrees(drape: FoldDrape) -> tuple[float, float]:
    """Largest shear, wing-fed and ribbon-fed."""
    wing_fed, ribbon_fed = drape.largest.wing_fed, drape.largest.ribbon_fed
    assert wing_fed is not None
    assert ribbon_fed is not None
    return float(np.degrees(wing_fed)), float(np.degrees(ribbon_fed))


def toml(design: dict[str, Any]) -> str:
    """The text of such a table."""
    plain = {key: value for key, value in design.items() if not isinstance(value, dict)}
    lines = [f"{key} = {_word(value)}" for key, value in plain.items()]
    for key, part in design.items():
        if isinstance(part, dict):
            lines += [f"[{key}]", *(f"{name} = {_word(value)}" for name, value in part.items())]
    return "\n".join(lines) + "\n"


def _word(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else repr(value)
