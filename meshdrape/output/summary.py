"""The summary of a drape, for machines."""

import json
import math
import os
from collections.abc import Mapping
from enum import Enum
from pathlib import PurePath
from typing import Any

import numpy as np

from meshdrape.output.files import atomic_write


def write_json(summary: Mapping[str, Any], path: str | os.PathLike[str]) -> None:
    """Write a summary as JSON that any reader accepts: UTF-8, indented, NaN and infinity as null.

    Raises
    ------
    FileError
        The file cannot be written.
    TypeError
        A value is of a kind that JSON has no word for.
    """
    text = json_text(summary)
    with atomic_write(path) as file:
        file.write(text.encode())


def json_text(summary: Mapping[str, Any]) -> str:
    """Return the JSON text of a summary, with a newline at its end."""
    text = json.dumps(_plain(summary), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    # the name of a file need not be Unicode: what stands for its bytes is escaped as JSON has it
    return text.encode("utf-8", "backslashreplace").decode()


def _plain(value: Any) -> Any:
    """Return `value` in the types of JSON: numpy's scalars and arrays, paths and enums spelt out."""
    if isinstance(value, Mapping):
        return {_key(name): _plain(item) for name, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, PurePath):
        return str(value)
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value


def _key(name: Any) -> str:
    return name.name if isinstance(name, Enum) else str(name)
