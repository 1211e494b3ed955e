"""The moulds that come with meshdrape: one CadQuery script each, found and run wherever the package is installed."""

from __future__ import annotations

import ast
import io
import math
import tokenize
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshdrape.errors import FileError

if TYPE_CHECKING:
    from meshdrape.mould.cad.shape import NamedShape
    from meshdrape.mould.mould import Mould

# What a script must do to be a mould; the one that writes the samples shows nothing.
SHOWS = "show_object("
# Where the wheel's data goes, under the prefix of the environment.
INSTALLED = ("share", "meshdrape", "cad")


@dataclass(frozen=True)
class Parameter:
    """A parameter of a script: its name, its default and what it means."""

    name: str
    default: Any
    meaning: str

    def value(self, word: Any) -> Any:
        """A word that the script has taken, in the type of the default."""
        if not isinstance(word, str) or isinstance(self.default, str):
            return word
        if isinstance(self.default, bool):
            return word.lower() in ("true", "yes", "1")
        return int(float(word)) if isinstance(self.default, int) and float(word).is_integer() else float(word)


@dataclass(frozen=True)
class Script:
    """A mould that comes with meshdrape.

    Attributes
    ----------
    name : str
    path : Path
    """

    name: str
    path: Path

    @cached_property
    def text(self) -> str:
        """The script itself."""
        return self.path.read_text(encoding="utf-8")

    @cached_property
    def summary(self) -> str:
        """What it makes, in one line."""
        return (ast.get_docstring(ast.parse(self.text)) or "").partition("\n")[0]

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The plain assignments at its top, which CQGI sets, with the comments beside them."""
        tokens = tokenize.generate_tokens(io.StringIO(self.text).readline)
        comment = {token.start[0]: token.string.lstrip("# ") for token in tokens if token.type == tokenize.COMMENT}
        return tuple(
            Parameter(node.targets[0].id, node.value.value, comment.get(node.lineno, ""))
            for node in ast.parse(self.text).body
            if isinstance(node, ast.Assign)
            and isinstance(node.targets[0], ast.Name)
            and isinstance(node.value, ast.Constant)
        )


def script_folder() -> Path:
    """The folder of the scripts: that of the sources, or where the wheel's data went.

    Raises
    ------
    FileError
        They are nowhere.
    """
    sources = Path(__file__).resolve().parents[3]
    if (sources / "pyproject.toml").is_file() and (sources / "cad").is_dir():
        return sources / "cad"
    if (beside := sources.joinpath(*INSTALLED)).is_dir():  # pip install --target
        return beside
    for installed in metadata.distributions(name="meshdrape"):
        for file in installed.files or ():
            folder = Path(str(file.locate())).parent
            if folder.parts[-3:] == INSTALLED and folder.is_dir():
                return folder.resolve()
    msg = f"the scripts of the moulds are not beside {sources} nor installed; install meshdrape anew"
    raise FileError(msg)


def scripts() -> dict[str, Script]:
    """Every mould there is a script for, by name."""
    found = (Script(path.stem, path) for path in sorted(script_folder().glob("*.py")))
    return {script.name: script for script in found if SHOWS in script.text}


def script(name: str) -> Script:
    """The script of one mould.

    Raises
    ------
    FileError
        There is no mould of that name; the message lists those there are.
    """
    known = scripts()
    if name not in known:
        msg = f"no mould is called {name!r}: {', '.join(known)}"
        raise FileError(msg)
    return known[name]


def checked_parameters(name: str, parameters: Mapping[str, Any] | None) -> dict[str, Any]:
    """The parameters of a script as it takes them.

    Raises
    ------
    FileError
        No such mould or parameter, or one that is not finite.
    """
    chosen = script(name)
    texts = {parameter.name for parameter in chosen.parameters if isinstance(parameter.default, str)}
    words = {
        key: _table_text(value) if key in texts and not isinstance(value, str) else value
        for key, value in (parameters or {}).items()
    }
    unknown = words.keys() - {parameter.name for parameter in chosen.parameters}
    if unknown:
        known = ", ".join(parameter.name for parameter in chosen.parameters)
        msg = f"mould {name} has no parameter {min(unknown)!r}: {known}"
        raise FileError(msg)
    for parameter in chosen.parameters:
        if not isinstance(parameter.default, str) and _is_endless(words.get(parameter.name)):
            msg = f"mould {name}: {parameter.name}={words[parameter.name]} is not a finite number"
            raise FileError(msg)
    return words


def build_shape(name: str, parameters: Mapping[str, Any] | None = None) -> NamedShape:
    """The B-rep that a script makes, its faces named: in this process, which a shape that cannot be may bring down.

    Parameters
    ----------
    name : str
        Of the script: "wing_spar", ...
    parameters : mapping, optional
        Numbers, words or truth values by name; lengths in mm. A table may be a pair of sequences (y, g).

    Raises
    ------
    FileError
        No such mould or parameter, or parameters that make no mould; one line that lists the known ones or says why.
    """
    from meshdrape.mould.cad.script import run_script

    words = checked_parameters(name, parameters)
    return run_script(script(name).path, words, f"mould {name}")


def build_script(
    name: str,
    parameters: Mapping[str, Any] | None = None,
    chord_tolerance: float | None = None,
    angle_tolerance: float | None = None,
) -> Mould:
    """The mould that a script makes, tessellated; no file is written.

    Parameters
    ----------
    name, parameters
        See :func:`build_shape`.
    chord_tolerance, angle_tolerance : float, optional
        mm and rad; see :func:`meshdrape.mould.cad.brep.cut_faces`.

    Returns
    -------
    Mould
        Its ``cad_faces`` bear the script's names, such as "wing" and "spar", by which ``triangle_face`` (the ids)
        tells whose a triangle is.

    Raises
    ------
    FileError
        See :func:`build_shape`.
    SelectionError
        The script makes a closed solid.
    MouldError
        A tolerance is out of range, or the surface cannot be draped.
    """
    from meshdrape.mould.cad.reader import script_mould
    from meshdrape.mould.files import file_sha256

    words, source = checked_parameters(name, parameters), script(name).path
    mould = script_mould(source, words, None, chord_tolerance, angle_tolerance, f"mould {name}")
    return replace(mould, source=source, sha256=file_sha256(source))


def _is_endless(value: Any) -> bool:
    """Whether a value, or the word for it, is NaN or infinite, which no shape can have."""
    try:
        return not math.isfinite(float(value))
    except (TypeError, ValueError):
        return False


def _table_text(table: Any) -> Any:
    """A table as its script takes it, y:g,y:g,... to the last digit."""
    try:
        y, values = table
        return ",".join(f"{float(at)!r}:{float(value)!r}" for at, value in zip(y, values, strict=True))
    except (TypeError, ValueError) as error:
        msg = f"{table!r} is neither a word nor a table, two sequences (y, g) of as many numbers"
        raise FileError(msg) from error
