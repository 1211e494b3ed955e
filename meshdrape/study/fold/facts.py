"""The answer in plain types, as `meshdrape fold --json` prints it: lengths in mm, angles in degrees."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdrape.study.fold.answer import (
    Choice,
    Envelope,
    FoldAnswer,
    Laying,
    Limit,
    NearestSpar,
    Pair,
    Shear,
    Where,
)
from meshdrape.study.fold.design import Design


def facts(answer: FoldAnswer) -> dict[str, Any]:
    """All of an answer but the maps; keys that end in ``_deg`` and ``_mm`` say their unit."""
    verdict = answer.verdict
    return {
        "design": _design(answer.design),
        "feasible": verdict.feasible,
        "margin_deg": _deg(verdict.margin),
        "locking_angle_deg": _deg(verdict.locking_angle),
        "gamma_deg": _deg(verdict.gamma),
        "gamma_best_deg": _deg(answer.laying.gamma_best),
        "max_shear_deg": {name: _shear(shear) for name, shear in verdict.criteria.items()},
        "first_sheet_max_shear_deg": _deg(verdict.first_sheet),
        "remarks": dict(verdict.remarks),
        "where": _where(answer.where),
        "laying": _laying(answer.laying),
        "largest_factor": answer.largest_factor,
        "largest_factors": {limit.rule: _limit(limit) for limit in answer.limits},
        "nearest_spar": _nearest(answer.nearest),
        "envelope": None if answer.envelope is None else _envelope(answer.envelope),
        "warnings": [
            {"kind": one.kind, "text": one.text, "y_mm": None if one.start is None else [one.start, one.end]}
            for one in answer.warnings
        ],
        "seconds": dict(answer.seconds),
    }


def _design(design: Design) -> dict[str, Any]:
    return {
        "file": None if design.source is None else str(design.source),
        "span_mm": design.span,
        "chord_mm": design.chord,
        "spar_height_mm": design.spar_height,
        "spacing_mm": design.spacing,
        "row_offset": design.row_offset,
        "wing": design.wing.name,
        "spar": None if design.spar is None else design.spar.name,
        "deviation": None if design.deviation is None else design.deviation.name,
        "first": design.first,
        "end": design.end,
        "rule": design.rule,
    }


def _shear(shear: Shear) -> dict[str, float | None]:
    return {"wing_fed": _deg(shear.wing_fed), "ribbon_fed": _deg(shear.ribbon_fed)}


def _where(where: Where) -> dict[str, Any]:
    return {
        "wing_fed": _pair(where.worst_wing_fed),
        "ribbon_fed": _pair(where.worst_ribbon_fed),
        "y_mm": _list(where.y),
        "psi_deg": _list(np.degrees(where.psi)),
        "wing_fed_deg": _list(np.degrees(where.wing_fed)),
        "ribbon_fed_deg": _list(np.degrees(where.ribbon_fed)),
    }


def _pair(pair: Pair | None) -> dict[str, Any] | None:
    if pair is None:
        return None
    return {
        "shear_deg": _deg(pair.shear),
        "row_crosses_at_y_mm": pair.y_row,
        "column_crosses_at_y_mm": pair.y_column,
        "place_mm": _list(pair.place),
    }


def _laying(laying: Laying) -> dict[str, Any]:
    return {"best": _choice(laying.best), "choices": [_choice(choice) for choice in laying.choices]}


def _choice(choice: Choice) -> dict[str, Any]:
    return {
        "first": choice.first,
        "end": choice.end,
        "rule": choice.rule,
        "gamma_deg": _deg(choice.gamma),
        "max_shear_deg": _shear(choice.shear),
        "returning_deg": _deg(choice.returning),
        "well_posed": choice.well_posed,
    }


def _limit(limit: Limit) -> dict[str, Any]:
    return {
        "factor": limit.factor,
        "gamma_deg": _deg(limit.gamma),
        "max_shear_deg": _shear(limit.shear),
        "tried": limit.tried if math.isfinite(limit.tried) else None,
    }


def _nearest(nearest: NearestSpar) -> dict[str, Any]:
    return {
        "measure": nearest.measure,
        "unchanged": nearest.unchanged,
        "proven": nearest.proven,
        "gamma_deg": _deg(nearest.gamma),
        "max_shear_deg": _shear(nearest.shear),
        "largest_loss_mm": nearest.largest_loss,
        "largest_loss_at_y_mm": nearest.largest_loss_at,
        "rms_loss_mm": nearest.rms_loss,
        "drapes": nearest.drapes,
        "y_mm": _list(nearest.y),
        "wanted_mm": _list(nearest.wanted),
        "f_mm": _list(nearest.nearest),
        "loss_mm": _list(nearest.loss),
    }


def _envelope(envelope: Envelope) -> dict[str, Any]:
    return {
        "family": envelope.family,
        "rule": envelope.rule,
        "spacing_mm": envelope.spacing,
        "amplitude_mm": [_list(row) for row in envelope.amplitude],
        "wavelength_mm": _list(envelope.wavelength),
        "allowed_mm": _list(envelope.allowed),
        "wing_fed_deg": [_list(row) for row in np.degrees(envelope.wing_fed)],
        "ribbon_fed_deg": [_list(row) for row in np.degrees(envelope.ribbon_fed)],
        "seconds": envelope.seconds,
    }


def _deg(angle: float | None) -> Any:
    return None if angle is None else math.degrees(angle)


def _list(values: NDArray[np.float64]) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]
