"""Named values in the comments of a PLY header: `comment NAME JSON`, floats to the last bit.

MeshLab refuses a header line of some 500 bytes, so a long value goes on in further comments of the same name.
"""

import json
from collections.abc import Iterable, Mapping
from typing import Any, Final

_LONGEST: Final = 200  # characters of JSON in one comment; always ASCII


def to_comments(values: Mapping[str, Any]) -> list[str]:
    """Return the comments that hold the values, by name, in their order."""
    comments = []
    for name, value in values.items():
        text = json.dumps(value, allow_nan=False)
        comments += [f"{name} {text[at : at + _LONGEST]}" for at in range(0, len(text), _LONGEST)]
    return comments


def from_comments(comments: Iterable[str]) -> dict[str, Any]:
    """Return the values by name that comments hold; a comment of another kind is passed over."""
    texts: dict[str, str] = {}
    for comment in comments:
        name, _, text = comment.partition(" ")
        texts[name] = texts.get(name, "") + text
    values = {}
    for name, text in texts.items():
        try:
            values[name] = json.loads(text)
        except ValueError:
            continue
    return values
