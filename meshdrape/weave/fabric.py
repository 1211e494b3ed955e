"""The woven sheet: two families of inextensible fibres hinged where they cross."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshdrape.errors import FabricError

# No cloth locks below this, rad: a number given in degrees that is smaller was meant in radians.
LEAST_LOCKING = math.radians(1.0)


@dataclass(frozen=True)
class Fabric:
    """A weave as the draping sees it.

    Attributes
    ----------
    spacing : float or (float, float)
        Distance from node to node, mm: one for both families, or (along warp, along weft).
    initial_angle : float
        Angle from warp to weft of the undeformed cloth, rad.
    locking_angle : float
        Shear at which the ribbons touch and the cloth locks, rad.

    Raises
    ------
    FabricError
        If a spacing is not positive and finite, or an angle is out of range.
    """

    spacing: float | tuple[float, ...]
    initial_angle: float = math.pi / 2
    locking_angle: float = math.radians(7.0)

    def __post_init__(self) -> None:
        """Check every number once."""
        # of numpy's arrays the numbers
        given = self.spacing.tolist() if hasattr(self.spacing, "tolist") else self.spacing
        spacings = [
            _number("spacing", value) for value in (given if isinstance(given, tuple | list) else (given, given))
        ]
        initial_angle, locking_angle = (
            _number(name.replace("_", " "), getattr(self, name)) for name in ("initial_angle", "locking_angle")
        )
        if len(spacings) != 2:
            msg = f"spacing has {len(spacings)} values; give one, or two: along warp and along weft"
            raise FabricError(msg)
        for name, value in zip(("warp", "weft"), spacings, strict=True):
            if not (math.isfinite(value) and value > 0):
                msg = f"{name} spacing is {value:g} mm; it must be a positive length"
                raise FabricError(msg)
        if not math.radians(5) <= initial_angle <= math.radians(175):
            msg = f"initial angle is {math.degrees(initial_angle):g} degrees; it must lie between 5 and 175"
            raise FabricError(msg)
        if not 0 < locking_angle < math.pi / 2:
            msg = f"locking angle is {math.degrees(locking_angle):g} degrees; it must lie between 0 and 90"
            raise FabricError(msg)
        object.__setattr__(self, "spacing", tuple(spacings) if spacings[0] != spacings[1] else spacings[0])
        object.__setattr__(self, "initial_angle", initial_angle)
        object.__setattr__(self, "locking_angle", locking_angle)

    @property
    def warp_spacing(self) -> float:
        """Distance between neighbouring nodes of a warp fibre, mm."""
        return self.spacing[0] if isinstance(self.spacing, tuple) else self.spacing

    @property
    def weft_spacing(self) -> float:
        """Distance between neighbouring nodes of a weft fibre, mm."""
        return self.spacing[1] if isinstance(self.spacing, tuple) else self.spacing

    @property
    def longest(self) -> float:
        """The wider of the two spacings, mm."""
        return max(self.warp_spacing, self.weft_spacing)

    @property
    def shortest(self) -> float:
        """The narrower of the two spacings, mm."""
        return min(self.warp_spacing, self.weft_spacing)


def _number(name: str, value: object) -> float:
    """A number of whatever kind, numpy's too, as a float; FabricError where it is none."""
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        msg = f"{name} is {value!r}; it must be a number"
        raise FabricError(msg) from None
