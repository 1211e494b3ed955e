"""The summary of a drape: what a user must know of it, in plain types."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdrape import __version__
from meshdrape.kernels import locate
from meshdrape.weave.fabric import LEAST_LOCKING
from meshdrape.weave.measures.balance import Balance
from meshdrape.weave.measures.cells import Measures
from meshdrape.weave.measures.field import MouldField
from meshdrape.weave.measures.noise import mesh_noise
from meshdrape.weave.net import Net
from meshdrape.weave.recheck.edges import Audit
from meshdrape.weave.start.fibre import FAMILY
from meshdrape.weave.status import NodeStatus

# Outcomes that leave fabric missing where it should lie.
MISSING = (
    NodeStatus.FOLDED,
    NodeStatus.STOPPED,
    NodeStatus.RECROSSED,
    NodeStatus.NOT_CONVERGED,
    NodeStatus.NOT_REACHED,
)
# Mesh noise above this share of the locking angle is worth a warning.
NOISE_SHARE = 0.1
# An arc's middle this near to -90 degrees, in half turns, is at 90: round-off must not choose.
HALF_TURN = 1e-9


def fabric_missing(net: Net) -> bool:
    """Whether fabric that should lie on the mould is missing."""
    return any(net.count(status) for status in MISSING)


def summarise(
    measures: Measures,
    field: MouldField,
    audit: Audit,
    balance: Balance,
    seconds: dict[str, float],
    command: str,
) -> dict[str, Any]:
    """Everything the summary states, ready for JSON: lengths in mm, areas in mm2, angles in degrees (``_deg``).

    Parameters
    ----------
    seconds : dict
        Time by stage.
    command : str
        The command line, or how the drape was asked for.
    """
    net, mould, fabric = measures.net, measures.net.mould, measures.net.fabric
    noise = mesh_noise(net.surface.mould_part)
    warp, weft, area = measures.cloth
    summary: dict[str, Any] = {
        "version": __version__,
        "command": command,
        "mould": {
            "file": None if mould.source is None else str(mould.source),
            "sha256": mould.sha256,
            "unit": mould.unit,
            "size_mm": np.round(mould.size, 6).tolist(),
            "area_mm2": mould.surface.area,
            "triangles": len(mould.triangles),
            "vertices": len(mould.vertices),
            "chord_tolerance_mm": mould.chord_tolerance,
            "angle_tolerance_deg": None if mould.angle_tolerance is None else math.degrees(mould.angle_tolerance),
            "healing": None if mould.healing is None else asdict(mould.healing),
        },
        "fabric": {
            "spacing_mm": [fabric.warp_spacing, fabric.weft_spacing],
            "initial_angle_deg": math.degrees(fabric.initial_angle),
            "locking_angle_deg": math.degrees(fabric.locking_angle),
        },
        "seed": net.seed.tolist(),
        "seed_distance_mm": net.seed_distance,
        "direction": net.direction.tolist(),
        "start_fibres": _start_fibres(net),
        "nodes": net.count(NodeStatus.PLACED),
        "cells": measures.n_cells,
        "cloth_mm": {"warp": warp, "weft": weft, "area_mm2": area},
        "max_shear_deg": math.degrees(measures.max_shear) if measures.n_cells else None,
        "max_shear_at": measures.max_shear_position.tolist() if measures.n_cells else None,
        "max_shear_face": measures.max_shear_face or None,
        "over_locking_percent": 100 * measures.over_locking_fraction,
        "coverage_percent": 100 * field.coverage_fraction,
        "reference": field.reference.tolist(),
        "warp_angle_deg": _angles(field, field.warp_angle),
        "weft_angle_deg": _angles(field, field.weft_angle),
        "statuses": {status.name: net.count(status) for status in NodeStatus if net.count(status)},
        "first_places": _first_places(net),
        "nodes_by_libigl": net.settled_by_libigl,
        "libigl_seconds": round(net.libigl_seconds, 3),
        "audit_max_relative_error": audit.max_relative_error,
        "audit": asdict(audit),
        "mesh_noise_deg": math.degrees(noise),
        "balance_residual_deg": None if balance.worst_cell is None else math.degrees(balance.worst),
        "balance_open_deg": math.degrees(balance.open),
        "balance_residual_at": None if balance.worst_position is None else balance.worst_position.tolist(),
        "faces": _by_cad_face(measures, field),
        "notes": [*mould.notes, *net.notes, *_meeting(net)],
        "warnings": [],
        "seconds": {stage: round(value, 3) for stage, value in seconds.items()},
    }
    summary["warnings"] = _warnings(measures, summary, noise)
    return summary


def _start_fibres(net: Net) -> dict[str, dict[str, Any]]:
    """How each generator runs: its turn at a crease, or how many points it was drawn through; null for neither."""
    given = net.start_fibres
    return {
        name: {
            "turn_deg": None if turn is None else math.degrees(turn),
            "path_points": None if path is None else len(path),
        }
        for name, turn, path in zip(FAMILY, given.turns, given.paths, strict=True)
    }


def _angles(field: MouldField, angle: Any) -> dict[str, float] | None:
    """Least, mean and largest fibre angle from the reference, and the mean deviation from it, by area.

    The least and the largest are the ends of the shortest arc that holds all: where fibres lie across the reference
    they reach past 90 degrees, or below -90.
    """
    on = field.covered
    if not on.any():
        return None
    least, largest = shortest_arc(angle[on])
    # a fibre has no sense: the mean is that of the doubled angles, on the arc's half turn
    mean = float(np.angle(np.average(np.exp(2j * angle[on]), weights=field.area[on]))) / 2
    mean += np.pi * round(((least + largest) / 2 - mean) / np.pi)
    return {
        "min": math.degrees(least),
        "mean": math.degrees(mean),
        "max": math.degrees(largest),
        "mean_deviation": math.degrees(float(np.average(np.abs(angle[on]), weights=field.area[on]))),
    }


def shortest_arc(angle: NDArray[np.float64]) -> tuple[float, float]:
    """Ends of the shortest arc that holds all of some undirected angles, rad; its middle lies in (-pi/2, pi/2].

    Parameters
    ----------
    angle : (n,) rad
        At least one, each known to within half a turn.
    """
    around = np.sort(np.mod(angle, np.pi))
    gap = np.diff(around, append=around[0] + np.pi)
    widest = int(np.argmax(gap))
    first = float(around[(widest + 1) % len(around)])
    length = math.pi - float(gap[widest])
    turns = math.ceil((first + length / 2 - np.pi / 2) / np.pi - HALF_TURN)
    return first - np.pi * turns, first + length - np.pi * turns


def _first_places(net: Net) -> dict[str, dict[str, Any]]:
    """For each outcome that lost fabric, the node nearest to the seed and the place of the node next to it."""
    i0, j0 = net.seed_index
    found = {}
    here = np.argwhere(net.node_status <= NodeStatus.OFF_MOULD)
    for status in (*MISSING, NodeStatus.MET_ITSELF):
        i, j = np.nonzero(net.node_status == status)
        if not len(i):
            continue
        n = int(np.argmin(np.abs(i - i0) + np.abs(j - j0)))
        # its parents may themselves have gone where the net meets itself
        a, b = here[np.argmin(np.abs(here - (i[n], j[n])).sum(axis=1))].tolist()
        place = net.positions(a, a + 1)[0, b]
        found[status.name] = {"node": [int(i[n] - i0), int(j[n] - j0)], "near": place.tolist()}
    return found


def _first(where: dict[str, Any]) -> str:
    """Where an outcome comes first, in words."""
    i, j = where["node"]
    near = where["near"]
    place = "" if near is None else f" near ({', '.join(f'{v:.1f}' for v in near)})"
    return f"first at node ({i}, {j}) from the seed{place}"


def _meeting(net: Net) -> list[str]:
    """That a net ends where it meets itself: no fault, but something to know."""
    n = net.count(NodeStatus.MET_ITSELF)
    if not n:
        return []
    where = _first(_first_places(net)[NodeStatus.MET_ITSELF.name])
    return [f"the net meets itself: {n:,} nodes MET_ITSELF, {where}"]


def _by_cad_face(measures: Measures, field: MouldField) -> list[dict[str, Any]]:
    """What lies on each CAD face: area, coverage, shear and warp angle."""
    net, mould, fabric = measures.net, measures.net.mould, measures.net.fabric
    if not mould.cad_faces:
        return []
    n = len(net.surface_face)
    largest, area, over = np.zeros(n), np.zeros(n), np.zeros(n)
    locate.cells_by_face(
        net.lattice, measures.cell_shear, measures.cell_touches_mould, fabric.locking_angle, fabric.initial_angle,
        largest, area, over,
    )  # fmt: skip
    ids = mould.triangle_face[net.surface_face]
    piece_ids = mould.triangle_face[field.parent]
    rows = []
    for face in mould.cad_faces:
        mine, pieces = ids == face.id, piece_ids == face.id
        whole = float(field.area[pieces].sum())
        cloth = float(area[mine].sum())
        on = pieces & field.covered
        rows.append(
            {
                "id": face.id,
                "name": face.name,
                "area_mm2": whole,
                "coverage_percent": 100 * float(field.area[on].sum()) / whole if whole else 0.0,
                "max_shear_deg": math.degrees(float(largest[mine].max())) if mine.any() else None,
                "over_locking_percent": 100 * float(over[mine].sum()) / cloth if cloth else 0.0,
                "mean_warp_angle_deg": math.degrees(
                    float(np.angle(np.average(np.exp(2j * field.warp_angle[on]), weights=field.area[on]))) / 2
                )
                if on.any()
                else None,
            }
        )
    return rows


def _warnings(measures: Measures, summary: dict[str, Any], noise: float) -> list[str]:
    net, fabric = measures.net, measures.net.fabric
    warnings = []
    if net.seed_distance > 1e-6 * fabric.warp_spacing:
        warnings.append(f"the seed was {net.seed_distance:.4g} mm off the mould and was projected on it")
    lock = math.degrees(fabric.locking_angle)
    if fabric.locking_angle < LEAST_LOCKING:
        warnings.append(
            f"no cloth locks at {lock:g} degrees; were {math.degrees(lock):.3g} meant, {lock:g} in radians?"
        )
    if measures.max_shear > fabric.locking_angle:
        warnings.append(
            f"the cloth locks: {summary['max_shear_deg']:.2f} degrees of shear where {lock:g} are possible, "
            f"{summary['over_locking_percent']:.2g} % of the area above"
        )
    warnings += [
        f"{net.count(status):,} nodes {status.name}, {_first(summary['first_places'][status.name])}"
        for status in MISSING
        if net.count(status)
    ]
    if noise > NOISE_SHARE * fabric.locking_angle:
        # a mesh file is as fine as it is
        is_mesh = net.mould.angle_tolerance is None
        finer = "mesh the mould finer" if is_mesh else "tessellate finer with --angle-tolerance"
        warnings.append(
            f"the mesh alone can falsify the shear by {math.degrees(noise):.2f} degrees, more than a tenth of the "
            f"locking angle; {finer}"
        )
    error = summary["audit_max_relative_error"]
    if error > 1e-7:
        warnings.append(f"an edge is {error:.1e} of its length off the shortest distance; see the audit")
    return warnings
