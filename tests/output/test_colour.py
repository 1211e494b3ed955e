"""The colour of shear: anchored, ordered by lightness, the same for a colour-blind eye."""

import numpy as np
import pytest

from meshdrape.output.colour import NO_CLOTH, WARP, WEFT, scale_position, shear_colour

LOCK = np.radians(7.0)
MARGIN = np.linspace(0.0, LOCK, 300)
OVER = np.geomspace(np.nextafter(LOCK, 1), np.pi / 2, 300)

# Machado, Oliveira and Fernandes (2009), doi 10.1109/TVCG.2009.113, severity 1, on linear RGB
EYES = {
    "normal": np.eye(3),
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "grey print": np.tile([0.2126729, 0.7151522, 0.0721750], (3, 1)),
}


def seen(rgba, eye):
    """CIELAB of a colour as an eye sees it."""
    value = np.asarray(rgba, dtype=float)[..., :3] / 255
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    linear = np.clip(linear @ EYES[eye].T, 0, 1)
    xyz = np.array(
        [
            [0.4124564, 0.3575761, 0.1804375],
            [0.2126729, 0.7151522, 0.0721750],
            [0.0193339, 0.1191920, 0.9503041],
        ]
    )
    f = np.cbrt(np.maximum(linear @ xyz.T / xyz.sum(axis=1), 1e-4))
    return np.stack([116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])], axis=-1)


@pytest.mark.parametrize("eye", EYES)
def test_lightness_falls_all_the_way(eye):
    lightness = seen(shear_colour(np.concatenate([MARGIN, OVER]), LOCK), eye)[:, 0]
    assert np.diff(lightness).max() < 0.6  # rounding to 8 bits
    assert lightness[0] - lightness[len(MARGIN) - 1] > 28
    assert lightness[len(MARGIN)] - lightness[-1] > 25


@pytest.mark.parametrize(
    ("eye", "jump"), [("normal", 80), ("protanopia", 80), ("deuteranopia", 80), ("grey print", 15)]
)
def test_the_locking_angle_is_a_jump_no_eye_can_miss(eye, jump):
    below, above = seen(shear_colour([LOCK, np.nextafter(LOCK, 1)], LOCK), eye)
    step = np.linalg.norm(np.diff(seen(shear_colour(MARGIN, LOCK), eye), axis=0), axis=1).max()
    assert np.linalg.norm(above - below) > jump > 10 * step


@pytest.mark.parametrize("lock_deg", [0.5, 3.0, 7.0, 33.3, 60.0, 89.0])
def test_the_scale_is_anchored_at_the_locking_angle_whatever_it_is(lock_deg):
    lock = np.radians(lock_deg)
    at, over = shear_colour([lock, np.nextafter(lock, 2)], lock)
    assert at.tolist() == shear_colour(LOCK, LOCK).tolist()
    assert over.tolist() == shear_colour(np.nextafter(LOCK, 1), LOCK).tolist()
    assert scale_position(lock, lock) == 0.5
    assert shear_colour(0.0, lock).tolist() == shear_colour(0.0, LOCK).tolist()


def test_shear_of_either_sign_has_one_colour():
    shear = np.random.default_rng(1).uniform(0, 1.5, (7, 5))
    assert (shear_colour(-shear, LOCK) == shear_colour(shear, LOCK)).all()
    assert shear_colour(shear, LOCK).shape == (7, 5, 4)


def test_where_there_is_no_cloth_the_grey_is_no_colour_of_the_scale():
    assert tuple(shear_colour(np.nan, LOCK)) == NO_CLOTH
    scale = shear_colour(np.concatenate([MARGIN, OVER]), LOCK)
    for eye in ("normal", "protanopia", "deuteranopia"):
        assert np.linalg.norm(seen(scale, eye) - seen(NO_CLOTH, eye), axis=1).min() > 8


def test_warp_and_weft_differ_for_every_eye():
    for eye in EYES:
        assert np.linalg.norm(seen(WARP, eye) - seen(WEFT, eye)) > 15


def test_beyond_the_scale_nothing_overflows():
    colours = shear_colour([np.pi / 2, 3.0, 1e9], LOCK)
    assert (colours == colours[0]).all()


def test_positions_run_from_zero_through_the_middle_to_one():
    position = scale_position(np.concatenate([MARGIN, OVER]), LOCK)
    assert (np.diff(position) >= 0).all()
    assert position[0] == 0
    assert position[-1] == pytest.approx(1)
    assert position[: len(MARGIN)].max() == 0.5
    assert position[len(MARGIN) :].min() > 0.5
    assert np.isnan(scale_position([np.nan], LOCK)).all()
