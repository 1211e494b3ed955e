"""Section 7 and 7.1: the continuum model and weakly curved surfaces."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from meshdrape.mould import Mould
from meshdrape.study.claims.claim import Claim, angle, number
from meshdrape.study.claims.drapes import MM, window
from meshdrape.study.claims.judgement import (
    Verdict,
    conditional,
    counterexample,
    equality,
    first_order,
    order_of,
    printed,
)
from meshdrape.study.claims.runs import Runs
from meshdrape.theory import (
    HeightField,
    SmoothNet,
    geodesic,
    plane_section,
    smooth_net,
    sphere_net,
    weak_nodes,
    weak_origami_sine,
    weak_origami_surface,
    weak_sine,
    weak_surface,
)
from meshdrape.weave.drape import drape
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.measures.cells import measure

FloatArray = NDArray[np.float64]

EPSILON = (0.02, 0.01, 0.005)
DOME, ASKEW, PLAIN = (1.0, 0.5, 0.7), (1.0, 1.0, 1.0), (1.0, 0.0, 0.0)  # a, b, c of (36)
ROUND_OFF_DEG = 1e-6


def _solved(field: HeightField, start: Callable[..., object], cells: int = 12) -> SmoothNet:
    """The net over the unit square from two start fibres along x and y, to sixth order."""
    warp, weft = start(field, (1, 0), 1.0), start(field, (0, 1), 1.0)
    return smooth_net(field, warp, weft, (1.0, 1.0), (cells, cells), levels=3)  # type: ignore[arg-type]


def _dome(a: float, b: float, c: float, epsilon: float, cells: int) -> Mould:
    """The surface (36) on a metre and a fifth, in mm."""
    side = np.linspace(-0.12, 1.2, cells + 1)
    x, y = np.meshgrid(side, side, indexing="ij")
    z = weak_surface(a, b, c, epsilon).z(x, y)
    k = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    p, q, r, s = k[:-1, :-1].ravel(), k[1:, :-1].ravel(), k[1:, 1:].ravel(), k[:-1, 1:].ravel()
    triangles = np.concatenate([np.stack([p, q, r], axis=1), np.stack([p, r, s], axis=1)])
    return Mould.from_arrays(MM * np.stack([x, y, z], axis=-1).reshape(-1, 3), triangles)


def _draped_corner(a: float, b: float, c: float, epsilon: float, *, sections: bool) -> float:
    """Sine of the shear at u = v = 1 m of a drape from plane sections or from geodesics."""
    warp = weft = None
    if sections:
        s, field = np.linspace(-0.115, 1.195, 437), weak_surface(a, b, c, epsilon)
        warp = MM * np.stack([s, 0 * s, field.z(s, 0 * s)], axis=1)
        weft = MM * np.stack([0 * s, s, field.z(0 * s, s)], axis=1)
    mould = _dome(a, b, c, epsilon, 60)
    net = drape(mould, Fabric(25.0), (0, 0, 0), (1, 0, 0), warp_path=warp, weft_path=weft)
    shear = window(net, measure(net).cell_shear, (41, 41))
    return float(np.sin(shear[39:41, 39:41].mean()))


def well_posed(runs: Runs) -> Claim:
    """(33), (34): fibres are characteristics, two of them determine the net."""
    del runs

    def cap(x: FloatArray, y: FloatArray) -> FloatArray:
        return np.sqrt(1 - x * x - y * y)

    sphere = HeightField(
        cap,
        lambda x, y: (-x / cap(x, y), -y / cap(x, y)),
        lambda x, y: (-(1 - y * y) / cap(x, y) ** 3, -x * y / cap(x, y) ** 3, -(1 - x * x) / cap(x, y) ** 3),
    )
    errors, speeds = [], []
    for cells in (8, 16, 32):
        start = geodesic(sphere, (1, 0), 0.8), geodesic(sphere, (0, 1), 0.8)
        net = smooth_net(sphere, *start, (0.8, 0.8), (cells, cells))
        errors.append(float(np.abs(net.node - sphere_net(1.0, net.u, net.v)).max()))
        speeds.append(float(np.max([np.abs(speed - 1).max() for speed in net.speeds])))
    found = (
        "March along the characteristics from two great circles, unit sphere, u = v = 0.8: off the sphere's "
        "own net by "
        f"{errors[-1]:.1e} at 32 steps, falling with a power {order_of(errors):.2f}; |x_u|, |x_v| off 1 by "
        f"{speeds[-1]:.1e},"
        f" {order_of(speeds):.2f}."
    )
    return Claim(
        "(33), (34)",
        "Fibres are characteristics; x on one and y on another give a well-defined solution.",
        found,
        equality([2 - order_of(errors), 2 - order_of(speeds)], 0.3),
    )


def shear_limit(runs: Runs) -> Claim:
    """(35) as printed."""
    del runs
    net = _solved(weak_surface(*DOME, 0.02), plane_section, 16)
    u, v = net.tangents
    true = np.pi / 2 - np.arccos(np.sum(u * v, axis=-1))
    as_printed = np.abs(u[..., 0] * v[..., 1])
    off = [np.degrees(np.arcsin(np.clip(value, 0, 1)) - np.abs(true)) for value in (as_printed, np.abs(net.sine))]
    found = (
        f"On a weak dome whose net shears by up to {angle(float(np.abs(true).max()))}: x_u y_v would make it "
        f"{np.degrees(np.arcsin(np.clip(as_printed, 0, 1))).max():.1f}°, x_u · x_v is right to "
        f"{number(float(np.abs(off[1]).max()), 6)}°."
    )
    return Claim(
        "(35)",
        "sin θ = |x_u · y_v|.",
        found,
        printed(off[0], off[1], 1e-6, "deg"),
        ((Verdict.MISPRINT, "|x_u · x_v|, both of the place in space."),),
    )


def equation_38(runs: Runs) -> Claim:
    """(38)."""
    del runs
    errors: dict[str, list[float]] = {"sections": [], "geodesics": []}
    for epsilon in EPSILON:
        for name, start in (("sections", plane_section), ("geodesics", geodesic)):
            net = _solved(weak_surface(*DOME, epsilon), start)
            u, v = np.meshgrid(net.u, net.v, indexing="ij")
            errors[name].append(float(np.abs(net.plane - weak_nodes(*DOME, epsilon, u, v)).max()))
    found = (
        "a, b, c = 1, 0.5, 0.7, ε from 0.02 to 0.005: the error falls with a power "
        f"{order_of(errors['sections']):.2f} of "
        f"ε from the plane sections x = 0 and y = 0, {order_of(errors['geodesics']):.2f} from geodesics."
    )
    return Claim(
        "(38)",
        "The nodes to O(ε) on a smooth surface, x = 0 on u = 0 and y = 0 on v = 0.",
        found,
        first_order(errors["sections"], 1.8),
        ((Verdict.FIRST_ORDER, "From those plane sections, which are geodesics only for b = 0."),),
    )


def equation_39(runs: Runs) -> Claim:
    """(39), and a drape of it."""
    errors = []
    for epsilon in EPSILON:
        net = _solved(weak_surface(*DOME, epsilon), plane_section)
        u, v = np.meshgrid(net.u, net.v, indexing="ij")
        errors.append(float(np.abs(net.sine - weak_sine(*DOME, epsilon, u, v)).max()))
    del runs
    one = _draped_corner(1, 0, 1, 0.01, sections=True)
    exact = float(_solved(weak_surface(1, 0, 1, 0.01), plane_section).sine[-1, -1])
    found = (
        f"The error of sin θ falls with a power {order_of(errors):.2f} of ε. a, b, c = 1, 0, 1, ε = 0.01, u = v = 1: "
        f"formula 0.04000, solved {exact:.5f}, draped on a mesh {one:.5f}."
    )
    return Claim("(39)", "sin θ = 2 ε [a b u² + 2 (ac - b²) u v + b c v²].", found, first_order([*errors], 1.8))


def cylinder_along(runs: Runs) -> Claim:
    """After (39): a cylinder with a fibre along its generators."""
    del runs
    sine = float(np.abs(_solved(weak_surface(*PLAIN, 0.02), plane_section).sine).max())
    draped = abs(_draped_corner(*PLAIN, 0.01, sections=False))
    found = f"b = c = 0: sin θ at most {sine:.0e} solved, {draped:.0e} draped on a mesh."
    return Claim(
        "after (39)",
        "A cylinder with one weave direction along its generators needs no shear.",
        found,
        equality(np.degrees([sine, draped]), ROUND_OFF_DEG, "deg"),
    )


def cylinder_askew(runs: Runs) -> Claim:
    """After (39): a cylinder laid askew must shear."""
    del runs
    epsilon = 0.01
    sections, geodesics = (
        float(_solved(weak_surface(*ASKEW, epsilon), start).sine[-1, -1]) for start in (plane_section, geodesic)
    )
    draped = [_draped_corner(*ASKEW, epsilon, sections=which) for which in (True, False)]
    formula = float(weak_sine(*ASKEW, epsilon, 1, 1))
    found = (
        f"a = b = c = 1, ε = 0.01, u = v = 1, formula {formula:.4f}: from plane sections {sections:.4f} (draped "
        f"{draped[0]:.4f}), from geodesics {geodesics:.0e} (draped {draped[1]:.1e})."
    )
    off = [abs(value / formula - 1) for value in (sections, geodesics)]
    return Claim(
        "after (39)",
        "On a cylinder whose generators the fibres do not follow the material must shear.",
        found,
        conditional(off[0], off[1], 0.1),
        ((Verdict.CONDITIONAL, "Only from the plane sections as start fibres; from geodesics there is none."),),
    )


def equation_40(runs: Runs) -> Claim:
    """(40) and the shear after it."""
    del runs
    errors = []
    for epsilon in EPSILON:
        net = _solved(weak_origami_surface(0.8, 0.6, epsilon), plane_section)
        errors.append(float(np.abs(net.sine - weak_origami_sine(0.8, 0.6, epsilon, net.v)[None]).max()))
    found = f"k = 0.8, c = 0.6: the error of sin θ falls with a power {order_of(errors):.2f} of ε from plane sections."
    return Claim(
        "(40)",
        "On z = sqrt(ε)(k x + c y²), a fibre along the x axis, sin θ = 2 ε c k v.",
        found,
        first_order(errors, 1.8),
    )


def only_cylinders(runs: Runs) -> Claim:
    """After (40): nothing else is free of shear."""
    del runs
    cone = HeightField.numerical(lambda x, y: -np.hypot(x + 2.0, y), 1e-3)
    shear = []
    for field in (cone, weak_surface(*ASKEW, 0.05), weak_origami_surface(0.8, 0.6, 0.02)):
        start = geodesic(field, (1, 0), 0.8), geodesic(field, (0, 1), 0.8)
        if field is not cone:  # at right angles on the surface where the seed's plane slopes: turn the second
            p, q = (float(g) for g in field.gradient(np.zeros(()), np.zeros(())))
            start = geodesic(field, (1, 0), 0.8), geodesic(field, (-p * q, 1 + p * p), 0.8)
        net = smooth_net(field, *start, (0.8, 0.8), (12, 12), levels=3)
        shear.append(float(np.abs(net.shear).max()))
    found = (
        f"From two geodesics at right angles: a cone shears by {angle(shear[0])}, a cylinder laid askew by "
        f"{angle(shear[1])}, the surface (40) by {angle(shear[2])}."
    )
    return Claim(
        "after (40)",
        "Only a cylinder with one family of fibres along its generators needs no shear at all.",
        found,
        counterexample(np.degrees(shear), 1e-4, "deg"),
        ((Verdict.WRONG, "Any developable surface will do, from two geodesics at right angles."),),
    )


CLAIMS = (
    well_posed,
    shear_limit,
    equation_38,
    equation_39,
    cylinder_along,
    cylinder_askew,
    equation_40,
    only_cylinders,
)
