"""The summary for machines is JSON that any reader takes."""

import json
from pathlib import Path

import numpy as np
import pytest

from meshdrape.errors import FileError
from meshdrape.output import json_text, write_json
from meshdrape.weave.status import NodeStatus


def test_numpy_nan_paths_and_statuses_become_plain_json(tmp_path):
    summary = {
        "nodes": np.int64(6_245_668),
        "max_shear_deg": np.float64(6.8427),
        "coverage_percent": np.float32(0.5),
        "balance_residual_deg": np.nan,
        "mesh_noise_deg": float("inf"),
        "max_shear_at": np.array([1.5, np.nan, 3.0]),
        "draped": np.bool_(True),
        "statuses": {NodeStatus.PLACED: 4, "OFF_MOULD": 2},
        "mould": Path("samples/Flügel.step"),
        "warnings": ("one", None),
    }
    write_json(summary, tmp_path / "net.json")
    text = (tmp_path / "net.json").read_text(encoding="utf-8")
    assert text == json_text(summary)
    assert text.endswith("}\n")

    def refuse(constant):
        raise AssertionError(constant)

    assert json.loads(text, parse_constant=refuse) == {
        "nodes": 6245668,
        "max_shear_deg": 6.8427,
        "coverage_percent": 0.5,
        "balance_residual_deg": None,
        "mesh_noise_deg": None,
        "max_shear_at": [1.5, None, 3.0],
        "draped": True,
        "statuses": {"PLACED": 4, "OFF_MOULD": 2},
        "mould": "samples/Flügel.step",
        "warnings": ["one", None],
    }


def test_what_json_has_no_word_for_leaves_no_file(tmp_path):
    with pytest.raises(TypeError):
        write_json({"odd": object()}, tmp_path / "net.json")
    assert not list(tmp_path.iterdir())


def test_a_missing_folder_is_told(tmp_path):
    with pytest.raises(FileError, match="does not exist"):
        write_json({}, tmp_path / "no" / "net.json")
