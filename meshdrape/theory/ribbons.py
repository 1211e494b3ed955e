"""Figure 2: the shear at which the ribbons of a weave touch, from their width and pitch.

Parallel ribbons lie one pitch p apart, measured along the ribbons that cross them, and keep that pitch under shear: the
crossings are pins, the ribbons inextensible. With the families at the angle σ the gap between neighbours is
p sin σ - w. It closes where sin σ = w / p: for a sheet woven at right angles at the shear arccos(w / p).

This holds for plain weave, twill and satin alike: whatever the order of over and under, neighbouring ribbons of a
family run side by side at the distance p sin σ over their whole length. What a weave changes, how far ribbons may slip
over one another, be squeezed narrower or rise out of the plane before that, is not geometry of figure 2 and not here.
"""

from __future__ import annotations

import numpy as np

from meshdrape.errors import FabricError


def locking_angle(
    width: float, pitch: float, other_width: float | None = None, other_pitch: float | None = None
) -> float:
    """Shear at which the ribbons touch, woven at right angles, rad.

    Parameters
    ----------
    width, pitch : float
        Of one family, any unit; pitch = width + gap.
    other_width, other_pitch : float, optional
        Of the other family where it differs; the family that touches first decides.
    """
    closing, _ = locking_range(width, pitch, np.pi / 2, other_width, other_pitch)
    return closing


def locking_range(
    width: float,
    pitch: float,
    initial_angle: float,
    other_width: float | None = None,
    other_pitch: float | None = None,
) -> tuple[float, float]:
    """Shear at which ribbons woven at any angle touch: angle closing and angle opening, rad, both positive."""
    full = max(
        _fullness(width, pitch),
        _fullness(width if other_width is None else other_width, pitch if other_pitch is None else other_pitch),
    )
    touch = float(np.arcsin(full))
    if not touch <= initial_angle <= np.pi - touch:
        msg = f"initial_angle={initial_angle} rad: ribbons filling {full:.3g} of their pitch overlap at this angle"
        raise FabricError(msg)
    return initial_angle - touch, np.pi - touch - initial_angle


def gap(width: float, pitch: float, shear: float) -> float:
    """Gap left between neighbouring ribbons of a square weave at a shear: p cos θ - w; negative past locking."""
    _fullness(width, pitch)
    return float(pitch * np.cos(shear) - width)


def width_for(locking: float, pitch: float) -> float:
    """Width of ribbon that locks at an angle: w = p cos θ, the inverse of `locking_angle`."""
    if not 0 <= locking < np.pi / 2:
        msg = f"locking angle {locking} rad: must lie between 0 and π/2"
        raise FabricError(msg)
    return float(pitch * np.cos(locking))


def _fullness(width: float, pitch: float) -> float:
    if not 0 < width <= pitch:
        msg = f"ribbons of width {width} at pitch {pitch}: the width must be positive and no more than the pitch"
        raise FabricError(msg)
    return width / pitch
