"""The scripts run through CadQuery's gateway as any other, and stand apart from the package."""

from __future__ import annotations

import ast
import importlib
import inspect
import subprocess
import sys
from pathlib import Path

import cadquery as cq
import make_samples
import pytest
from cadquery import cqgi

CAD = Path(make_samples.__file__).parent
SCRIPTS = sorted({sample.script.__name__ for sample in make_samples.SAMPLES})
each_script = pytest.mark.parametrize("name", SCRIPTS)


def read(name: str) -> cqgi.CQModel:
    return cqgi.parse((CAD / f"{name}.py").read_text(encoding="utf-8"))


def test_every_mould_has_samples():
    assert sorted(path.stem for path in CAD.glob("*.py")) == sorted([*SCRIPTS, "make_samples"])


@each_script
def test_gateway_offers_exactly_the_parameters_of_build(name):
    offered = {key: value.default_value for key, value in read(name).metadata.parameters.items()}
    signature = inspect.signature(importlib.import_module(name).build)
    assert offered == {key: value.default for key, value in signature.parameters.items()}
    assert all(value.kind is inspect.Parameter.KEYWORD_ONLY for value in signature.parameters.values())


@each_script
def test_gateway_shows_the_shape_that_build_makes(name):
    result = read(name).build()
    assert result.success, result.exception
    assert len(result.results) == 1
    shown = result.first_result.shape
    assert isinstance(shown, cq.Workplane)
    assert shown.val().Area() == pytest.approx(importlib.import_module(name).build().val().Area(), rel=1e-12)


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        ("hemisphere", {"radius": 80}),
        ("cylinder", {"radius": 80, "length": 100.5, "arc_deg": 90}),
        ("cone", {"half_angle_deg": 40, "slant_from": 50, "slant_to": 90, "arc_deg": 30}),
        ("hypar", {"k": 0.01, "side": 100, "border_edges": 3}),
        ("cube_corner", {"side": 7}),
        ("krogh_double_curved", {"side": 400}),
        ("wing_spar", {"deviation": "sine", "c": 50, "wavelength": 3500}),
        ("wing_spar", {"block": True, "span": 3000}),
        ("wing_spar", {"wing_profile": "table", "wing_table": "0:0,7000:600,14000:1500"}),
        ("hat", {"radius": 80, "fillet_radius": 10, "rim_radius": 150}),
        ("double_dome", {"radius": 50, "distance": 180, "waist_radius": 150, "rim_length": 500, "rim_width": 300}),
        ("saddle", {"radius_x": 2000, "radius_y": 700, "length": 500, "width": 900}),
        ("pyramid", {"sides": 5, "apex_angle_deg": 50, "slant": 300}),
        ("joggle", {"depth": 20, "ramp_angle_deg": 45, "radius": 5, "before": 30, "after": 40, "width": 50}),
        ("l_corner", {"upper": 30, "lower": 20, "radius": 5, "angle_deg": 60, "width": 100}),
        ("c_spar", {"span": 900, "root_height": 200, "tip_height": 90, "flange": 50, "fillet_radius": 8}),
        ("leading_edge", {"naca": "0015", "chord": 800, "tip_chord": 300, "sweep_deg": 10, "depth": 0.2, "span": 900}),
        ("blade_root", {"root_diameter": 700, "chord": 900, "thickness": 0.2, "twist_deg": -5, "axis_fraction": 0.25}),
    ],
)
def test_gateway_passes_every_parameter_on(name, parameters):
    result = read(name).build(parameters)
    assert result.success, result.exception
    script = importlib.import_module(name)
    area = result.first_result.shape.val().Area()
    assert area == pytest.approx(script.build(**parameters).val().Area(), rel=1e-12)
    assert area != pytest.approx(script.build().val().Area(), rel=1e-9)


@each_script
def test_unknown_parameter_fails(name):
    result = read(name).build({"colour": 1})
    assert not result.success
    assert isinstance(result.exception, cqgi.InvalidParameterError)
    assert "colour" in str(result.exception)


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        ("hemisphere", {"radius": 0}),
        ("cylinder", {"arc_deg": 360}),
        ("cylinder", {"length": -1}),
        ("cone", {"half_angle_deg": 90}),
        ("cone", {"slant_from": 2000}),
        ("cone", {"arc_deg": 0}),
        ("hypar", {"side": 0}),
        ("hypar", {"border_edges": 2.5}),
        ("cube_corner", {"side": -3}),
        ("krogh_double_curved", {"side": 0}),
        ("hat", {"radius": 0}),
        ("hat", {"rim_radius": 110}),
        ("double_dome", {"fillet_radius": 60}),
        ("double_dome", {"distance": 340}),
        ("double_dome", {"rim_length": 370}),
        ("saddle", {"radius_y": -1}),
        ("pyramid", {"sides": 2}),
        ("pyramid", {"apex_angle_deg": 90}),
        ("joggle", {"depth": 3}),
        ("joggle", {"ramp_angle_deg": 90}),
        ("l_corner", {"angle_deg": 180}),
        ("l_corner", {"radius": 0}),
        ("c_spar", {"fillet_radius": 80}),
        ("c_spar", {"flange": 0}),
        ("leading_edge", {"depth": 0.5}),
        ("leading_edge", {"depth": 1.0}),
        ("leading_edge", {"sweep_deg": 85}),
        ("blade_root", {"thickness": 1.5}),
        ("blade_root", {"axis_fraction": -1}),
        ("wing_spar", {"span": 14}),
        ("wing_spar", {"spar_angle_deg": 180}),
    ],
)
def test_parameters_that_make_no_mould_are_refused_by_name(name, parameters):
    result = read(name).build(parameters)
    assert isinstance(result.exception, ValueError)
    assert f"{next(iter(parameters))}={next(iter(parameters.values()))}" in str(result.exception)


def test_scripts_import_nothing_of_the_package():
    for path in CAD.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            modules = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            modules += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not any(module.split(".")[0] == "meshdrape" for module in modules), path


def test_plain_import_has_no_side_effect():
    """No shape is made and nothing printed when the scripts are imported."""
    code = f"""
import sys
from unittest.mock import patch
import cadquery
sys.path.insert(0, {str(CAD)!r})
with patch.object(cadquery.Workplane, "__init__", side_effect=AssertionError("a shape was made")):
    import make_samples
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")
