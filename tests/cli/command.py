"""The command as its user meets it: words in; exit code, stdout and stderr out."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from moulds import Mesh

from meshdrape.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "samples"
CAD = ROOT / "cad"


class Outcome(NamedTuple):
    code: int
    out: str
    err: str


def run(capfd: pytest.CaptureFixture[str], *words: object) -> Outcome:
    """The command run in this process; what C++ code prints is caught too."""
    capfd.readouterr()
    code = main([str(word) for word in words])
    return Outcome(code, *capfd.readouterr())


def draped(capfd: pytest.CaptureFixture[str], mould: object, net: Path, *options: object, code: int = 0) -> Any:
    """The summary read back from beside the net; no picture."""
    outcome = run(capfd, "drape", mould, "-o", net, "--quiet", "--no-picture", *options)
    assert outcome == (code, "", "")
    return json.loads(net.with_suffix(".json").read_text())


def binary_stl(mesh: Mesh) -> bytes:
    corners = mesh.vertices[mesh.triangles].astype("<f4")
    facets = b"".join(struct.pack("<3f", 0, 0, 0) + corner.tobytes() + b"\0\0" for corner in corners)
    return bytes(80) + struct.pack("<I", len(corners)) + facets


def ascii_stl(mesh: Mesh) -> bytes:
    lines = ["solid mould"]
    for corners in mesh.vertices[mesh.triangles]:
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {x!r} {y!r} {z!r}" for x, y, z in corners.tolist())]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid mould", ""]).encode()


def obj(mesh: Mesh) -> bytes:
    rows = ["v " + " ".join(map(repr, row)) for row in np.asarray(mesh.vertices, dtype=float).tolist()]
    rows += ["f " + " ".join(map(str, row)) for row in (mesh.triangles + 1).tolist()]
    return ("\n".join(rows) + "\n").encode()


def off(mesh: Mesh) -> bytes:
    rows = ["OFF", f"{len(mesh.vertices)} {len(mesh.triangles)} 0"]
    rows += [" ".join(map(repr, row)) for row in np.asarray(mesh.vertices, dtype=float).tolist()]
    rows += ["3 " + " ".join(map(str, row)) for row in mesh.triangles.tolist()]
    return ("\n".join(rows) + "\n").encode()


def ply(mesh: Mesh) -> bytes:
    head = (
        f"ply\nformat ascii 1.0\nelement vertex {len(mesh.vertices)}\nproperty double x\nproperty double y\n"
        f"property double z\nelement face {len(mesh.triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    return head.encode() + b"\n".join(off(mesh).splitlines()[2:]) + b"\n"
