"""A CadQuery script run through CadQuery's own gateway (CQGI), its parameters set by name."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path
from typing import Any

from meshdrape.errors import FileError
from meshdrape.mould.cad.shape import NamedShape, cadquery_module, of_shape
from meshdrape.mould.files import brief


def run_script(path: Path, parameters: Mapping[str, Any] | None = None, origin: str | None = None) -> NamedShape:
    """The shape that a CadQuery script shows, mm, its tagged faces named by their tags.

    The interpreter itself crashes on an expression that is nested deeply enough, and Open CASCADE on some shapes:
    call it in a process of its own (:func:`~meshdrape.mould.apart.apart`).

    Parameters
    ----------
    path : Path
    parameters : mapping, optional
        Values, or the words for them, by the names of the script's plain assignments.
    origin : str, optional
        What messages call the script, default its path. A script called otherwise is one of ours, whose refusals
        need no line number.

    Raises
    ------
    FileError
        If the script cannot be parsed, raises, shows nothing, or has no parameter of a given name.
    """
    cq = cadquery_module()
    from cadquery import cqgi

    called = origin or str(path)
    try:
        text = path.read_text(encoding="utf-8")
        model = cqgi.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        line = f", line {error.lineno}" if isinstance(error, SyntaxError) else ""
        msg = f"{path}{line} is not a Python script: {brief(error)}"
        raise FileError(msg) from error
    known = model.metadata.parameters
    values = {}
    for name, word in (parameters or {}).items():
        if name not in known:
            listed = ", ".join(f"{key}={parameter.default_value}" for key, parameter in known.items()) or "none"
            msg = f"{called} has no parameter {name!r}; it has {listed}"
            raise FileError(msg)
        values[name] = _value(called, name, word, known[name])
    try:
        with redirect_stdout(sys.stderr):  # what the script prints is none of our output
            result = model.build(build_parameters=values)
    except SystemExit as error:
        msg = f"{path}{_line_of(error)} ends the program; let it end with show_object(shape) instead"
        raise FileError(msg) from error
    if not result.success:
        raised = result.exception
        if origin and isinstance(raised, ValueError):
            msg = f"{origin}: {brief(raised)}"
            raise FileError(msg) from raised
        msg = f"{path}{_line_of(raised)} failed: {type(raised).__name__}: {brief(raised)}"
        raise FileError(msg)
    shapes = [shape for shown in result.results for shape in _shapes(cq, shown.shape)]
    if not shapes:
        msg = f"{path} shows no shape; end it with show_object(shape)"
        raise FileError(msg)
    found = of_shape(shapes[0] if len(shapes) == 1 else cq.Compound.makeCompound(shapes), path)
    tags = [tag for shown in result.results for tag in _tagged_faces(cq, shown.shape)]
    return replace(found, names=tuple(_name(face, tags) for face in found.faces))


def _value(called: str, name: str, word: Any, parameter: Any) -> Any:
    """A word from the command line as a value of the parameter's own type."""
    from cadquery import cqgi

    if not isinstance(word, str) or parameter.varType is cqgi.StringParameterType:
        return word
    if parameter.varType is cqgi.BooleanParameterType:
        truth = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}.get(word.lower())
        if truth is None:
            msg = f"{called}: {name}={word} is not true or false"
            raise FileError(msg)
        return truth
    default = parameter.default_value
    defaults = default if isinstance(default, tuple) else (default,)
    words = word.split(",")
    try:
        numbers = [float(part) for part in words]
    except ValueError:
        numbers = []
    if len(numbers) != len(defaults):
        what = "a number" if defaults == (default,) else f"{len(defaults)} numbers separated by commas"
        msg = f"{called}: {name}={word} is not {what}; its default is {default}"
        raise FileError(msg)
    values = tuple(
        int(number) if isinstance(usual, int) and number.is_integer() else number
        for number, usual in zip(numbers, defaults, strict=True)
    )
    return values if isinstance(default, tuple) else values[0]


def _shapes(cq: Any, shown: Any) -> list[Any]:
    if isinstance(shown, cq.Workplane):
        return [value for value in shown.vals() if isinstance(value, cq.Shape)]
    if isinstance(shown, cq.Assembly):
        return [shown.toCompound()]
    return [shown] if isinstance(shown, cq.Shape) else []


def _tagged_faces(cq: Any, shown: Any) -> list[tuple[str, Any]]:
    """Tags of a workplane's chain, and the faces that bear them."""
    if not isinstance(shown, cq.Workplane):
        return []
    tags = shown.ctx.tags.items()
    return [(tag, value) for tag, tagged in tags for value in tagged.vals() if isinstance(value, cq.Face)]


def _name(face: Any, tags: list[tuple[str, Any]]) -> str | None:
    return next((tag for tag, tagged in tags if tagged.isSame(face)), None)


def _line_of(error: BaseException | None) -> str:
    """Where in the script an exception arose."""
    trace = error.__traceback__ if error is not None else None
    line = None
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == "<cqscript>":
            line = trace.tb_lineno
        trace = trace.tb_next
    return f", line {line}," if line else ""
