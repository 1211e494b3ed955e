"""The colour of shear, anchored at the locking angle.

Up to the locking angle the scale runs from pale yellow (all the margin is left) through pale cyan to blue
(none is left); past it the colour jumps to vermilion and darkens to maroon at 90 degrees. Lightness falls all
the way, by equal steps of CIELAB L*, so a grey print reads the same; yellow, blue and vermilion differ for a
colour-blind eye too. Two nets of one fabric have the same scale, whatever their shear.
"""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

NO_CLOTH: Final = (190, 190, 190, 255)
"""Where there is no shear to show: mould without cloth, a node without a whole cell."""
WARP: Final = (32, 32, 38, 255)
"""Fibres of the warp."""
WEFT: Final = (150, 40, 140, 255)
"""Fibres of the weft."""

_STEPS: Final = 256  # colours on each side of the locking angle
_MARGIN: Final = ((252, 249, 222), (186, 224, 222), (98, 164, 224))  # no shear ... locking angle
_OVER: Final = ((206, 62, 14), (88, 8, 26))  # just over the locking angle ... 90 degrees

# linear sRGB to CIE XYZ, D65 (IEC 61966-2-1)
_XYZ: Final = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
_WHITE: Final = _XYZ.sum(axis=1)


def shear_colour(shear: ArrayLike, locking_angle: float) -> NDArray[np.uint8]:
    """Return the colour of each shear angle, RGBA, shape (..., 4).

    Parameters
    ----------
    shear : array_like, shape (...)
        rad, of either sign: the colour shows the absolute value. NaN becomes the grey of `NO_CLOTH`.
    locking_angle : float
        rad, in (0, pi/2]. A shear equal to it still has the last blue.
    """
    position = scale_position(shear, locking_angle)
    # the jump lies between the two middle rows, which share the position 0.5
    row = (2.0 * (_STEPS - 1) * np.nan_to_num(position) + 0.5).astype(np.int16) + (position > 0.5)
    row = np.where(np.isnan(position), 2 * _STEPS, row)
    return np.take(_TABLE, row, axis=0)


def scale_position(shear: ArrayLike, locking_angle: float) -> NDArray[np.float64]:
    """Return where each shear angle lies on the scale's bar, in [0, 1], NaN for NaN, shape (...).

    The locking angle is at 0.5. Below it the bar is linear in shear, above it logarithmic up to 90 degrees
    at 1: each doubling of shear darkens alike, so that 10 and 20 degrees are still told apart on a mould that
    reaches 60.
    """
    magnitude = np.abs(np.asarray(shear, dtype=np.float64))
    position = np.asarray(0.5 * magnitude / locking_angle)
    over = magnitude > locking_angle
    if over.any():
        octaves = np.log(max(0.5 * np.pi / locking_angle, 1.0 + 1e-9))
        beyond = np.log(magnitude[over] / locking_angle) / octaves
        # the smallest step over 0.5 keeps a shear just over the locking angle on the far side of the jump
        position[over] = np.clip(0.5 + 0.5 * beyond, np.nextafter(0.5, 1.0), 1.0)
    return position


def _table() -> NDArray[np.uint8]:
    """Return the rows of the scale: `_STEPS` up to the locking angle, `_STEPS` over it, and no cloth."""
    rgb = np.concatenate([_ramp(_MARGIN), _ramp(_OVER), [NO_CLOTH[:3]]])
    table = np.full((len(rgb), 4), 255, dtype=np.uint8)
    table[:, :3] = np.clip(np.rint(rgb), 0, 255)
    return table


def _ramp(anchors: tuple[tuple[int, int, int], ...]) -> NDArray[np.float64]:
    """Return `_STEPS` sRGB colours through the anchors, evenly spaced in lightness, shape (_STEPS, 3)."""
    lab = _lab(np.array(anchors, dtype=np.float64))
    lightness = np.linspace(lab[0, 0], lab[-1, 0], _STEPS)
    falling = slice(None, None, -1)  # np.interp wants rising abscissae
    return _srgb(np.stack([np.interp(lightness, lab[falling, 0], lab[falling, k]) for k in range(3)], axis=1))


def _lab(srgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return CIELAB (D65) of sRGB in 0..255, shape (..., 3)."""
    value = srgb / 255.0
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    ratio = linear @ _XYZ.T / _WHITE
    f = np.where(ratio > 216 / 24389, np.cbrt(ratio), (24389 / 27 * ratio + 16) / 116)
    return np.stack([116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])], axis=-1)


def _srgb(lab: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return sRGB in 0..255 of CIELAB (D65), shape (..., 3); the inverse of `_lab`."""
    middle = (lab[..., 0] + 16) / 116
    f = np.stack([middle + lab[..., 1] / 500, middle, middle - lab[..., 2] / 200], axis=-1)
    ratio = np.where(f**3 > 216 / 24389, f**3, (116 * f - 16) * 27 / 24389)
    linear = np.maximum((ratio * _WHITE) @ np.linalg.inv(_XYZ).T, 0.0)
    return np.asarray(255 * np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055))


_TABLE: Final = _table()
