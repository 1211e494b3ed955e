"""The summary of a drape for people: a row a fact, then faces, notes, warnings and files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

# A residual of the curvature balance below this, degrees, is round-off.
ROUND_OFF = 1e-6

Rows = list[tuple[str, str]]


def drape_text(summary: dict[str, Any], written: Sequence[Path] = ()) -> str:
    """The page.

    Parameters
    ----------
    summary : dict
        As :func:`meshdrape.weave.summary.summarise` makes it, with "refinement" where there was one.
    written : sequence of Path
        The files to name at its end.
    """
    rows = [
        ("mould", _mould(summary["mould"])),
        ("seed", f"({_list(summary['seed'], 3)})"),
        *_start_fibres(summary["start_fibres"]),
        *_cloth(summary),
        *_shear(summary),
        ("mesh noise", f"{summary['mesh_noise_deg']:.3f} deg: hardly a cell is farther off for lying on facets"),
        ("balance", _balance(summary)),
        ("audit", _audit(summary)),
        ("time", ", ".join(f"{stage} {seconds:.2f} s" for stage, seconds in summary["seconds"].items())),
        *((f"face {face['id']}", _face(face)) for face in summary["faces"]),
        *(("note", note) for note in summary["notes"]),
        *(("WARNING", warning) for warning in summary["warnings"]),
        *(("wrote", str(path)) for path in written),
    ]
    return "".join(f"{name:>10}  {text}\n" for name, text in rows)


def _mould(mould: dict[str, Any]) -> str:
    size = " x ".join(f"{length:,.0f}" for length in mould["size_mm"])
    text = f"{mould['file']}, {size} mm, {mould['triangles']:,} triangles"
    if mould["angle_tolerance_deg"] is not None:
        text += f" at {mould['angle_tolerance_deg']:g} deg and {mould['chord_tolerance_mm']:g} mm"
    return text


def _start_fibres(fibres: dict[str, Any]) -> Rows:
    """What was prescribed; nothing of a straight one."""
    rows = []
    for name, fibre in fibres.items():
        if fibre["path_points"] is not None:
            rows.append((f"{name} fibre", f"drawn through {fibre['path_points']} points"))
        if fibre["turn_deg"] is not None:
            rows.append((f"{name} fibre", f"turned by {fibre['turn_deg']:g} deg at the crease"))
    return rows


def _cloth(summary: dict[str, Any]) -> Rows:
    cloth = summary["cloth_mm"]
    woven = " x ".join(f"{spacing:g}" for spacing in dict.fromkeys(summary["fabric"]["spacing_mm"]))
    return [
        ("net", f"{summary['nodes']:,} nodes, {summary['cells']:,} cells, spacing {woven} mm"),
        ("cloth", f"{cloth['warp']:,.0f} x {cloth['weft']:,.0f} mm, {cloth['area_mm2'] / 1e6:.3f} m2"),
        ("coverage", f"{summary['coverage_percent']:.2f} % of the mould"),
    ]


def _shear(summary: dict[str, Any]) -> Rows:
    if summary["max_shear_deg"] is None:
        return [("max shear", "none: no whole cell lies on the mould")]
    face = summary["max_shear_face"]
    where = f" at ({_list(summary['max_shear_at'])})" + (f", face {face}" if face else "")
    rows = [("max shear", f"{summary['max_shear_deg']:.3f} deg{where}")]
    if "refinement" in summary:
        bar = summary["refinement"]
        tried = " / ".join(f"{value:.3f}" for value in bar["max_shear_deg"])
        rows.append((
            "refined",
            f"max shear +- {bar['error_bar_deg']:.2g} deg ({tried} on {bar['triangles'][0]:,} to "
            f"{bar['triangles'][2]:,} triangles); +- {bar['spacing_error_deg']:.2g} deg for the spacing",
        ))  # fmt: skip
    lock = summary["fabric"]["locking_angle_deg"]
    rows.append(("locking", f"{summary['over_locking_percent']:.2f} % of the area above {lock:g} deg"))
    if summary["warp_angle_deg"]:
        angle = summary["warp_angle_deg"]
        told = f"{angle['min']:.2f} to {angle['max']:.2f} deg from the reference, mean {angle['mean']:.2f}"
        rows.append(("warp angle", told))
    return rows


def _balance(summary: dict[str, Any]) -> str:
    at = summary["balance_residual_at"]
    if at is None:
        return "no cell whose shear could be foretold"
    off, left_open = summary["balance_residual_deg"], summary["balance_open_deg"]
    text = f"shear within {off:.2g} deg of the enclosed curvature's, worst at ({_list(at)})"
    return text if off <= left_open + ROUND_OFF else f"{text}, more than the {left_open:.2g} deg that this leaves open"


def _audit(summary: dict[str, Any]) -> str:
    error = summary["audit_max_relative_error"]
    return f"{summary['audit']['n_edges']:,} edges by libigl, largest relative error {error:.1e}"


def _face(face: dict[str, Any]) -> str:
    shear = f"max shear {face['max_shear_deg'] or 0:.3f} deg, {face['over_locking_percent']:.1f} % above locking"
    return f"{face['name'] or ''} covered {face['coverage_percent']:.1f} %, {shear}"


def _list(values: Iterable[float], decimals: int = 1) -> str:
    return ", ".join(f"{value:.{decimals}f}" for value in values)
