"""The compiled kernels of an earlier version must never run: a wrong number would look like a right one."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import meshdrape

KERNELS = Path(meshdrape.__file__).parent / "kernels"
INNER = "from meshdrape.kernels.cache import kernel\n@kernel\ndef inner(x):\n    return x + {}\n"
OUTER = (
    "from meshdrape.kernels.cache import kernel\nfrom meshdrape.kernels.inner import inner\n"
    "@kernel\ndef outer(x):\n    return 10 * inner(x)\n"
)
ASK = """
from meshdrape.kernels.cache import compilation_told
from meshdrape.kernels.outer import outer
told = []
with compilation_told(lambda: told.append(1)):
    print(outer(1))
print(sum(outer.stats.cache_hits.values()))
assert len(told) == 1 - sum(outer.stats.cache_hits.values()), told
"""


@pytest.fixture
def kernels(tmp_path: Path) -> Path:
    """Two kernels of their own in a package of the same name, one compiled into the other."""
    folder = tmp_path / "meshdrape" / "kernels"
    folder.mkdir(parents=True)
    for empty in (folder.parent, folder):
        (empty / "__init__.py").touch()
    for name in ("cache.py", "blas.py"):
        shutil.copy(KERNELS / name, folder)
    (folder / "inner.py").write_text(INNER.format(1))
    (folder / "outer.py").write_text(OUTER)
    return folder


def ask(kernels: Path, **settings: str) -> tuple[int, int]:
    """The outer kernel's answer, and how often its machine code came from an earlier run; told of where it did not."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
    environment |= {"PYTHONPATH": str(kernels.parents[1]), **settings}
    command = [sys.executable, "-P", "-c", ASK]
    run = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    answer, hits = run.stdout.split()
    return int(answer), int(hits)


@pytest.mark.parametrize("told", [False, True])
def test_a_kernel_is_compiled_anew_when_one_it_calls_changes(kernels, tmp_path, told):
    settings = {"NUMBA_CACHE_DIR": str(tmp_path / "told")} if told else {}
    assert ask(kernels, **settings) == (20, 0)
    assert ask(kernels, **settings) == (20, 1)
    (kernels / "inner.py").write_text(INNER.format(2))
    assert ask(kernels, **settings) == (30, 0)
    assert ask(kernels, **settings) == (30, 1)
    left = list((tmp_path / "told" if told else kernels / "__pycache__").glob("kernels-*"))
    assert len(left) == (2 if told else 1)  # beside the sources nothing is left of kernels that are no more


def test_a_kernel_is_compiled_once_for_all_integers(kernels):
    """A constant, a narrow integer and a variable are one form to it."""
    (kernels / "outer.py").write_text(
        OUTER.replace("inner(x)", "(inner(x) + inner(4) + inner(np.int32(x)))").replace(
            "from", "import numpy as np\nfrom", 1
        )
    )
    program = "from meshdrape.kernels.outer import inner, outer; print(outer(1), len(inner.signatures))"
    environment = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
    environment["PYTHONPATH"] = str(kernels.parents[1])
    run = subprocess.run(
        [sys.executable, "-P", "-c", program], env=environment, check=True, capture_output=True, text=True
    )
    assert run.stdout.split() == ["90", "1"]


def test_where_the_package_cannot_be_written_the_user_keeps_the_kernels(kernels, tmp_path):
    (kernels / "__pycache__").write_text("a file where numba would make a folder")
    settings = {"XDG_CACHE_HOME": str(tmp_path / "caches")}
    assert ask(kernels, **settings) == (20, 0)
    assert ask(kernels, **settings) == (20, 1)
    assert list((tmp_path / "caches" / "meshdrape").glob("kernels-*"))


def test_where_nothing_can_be_written_the_kernels_still_run(kernels, tmp_path):
    (kernels / "__pycache__").write_text("a file where numba would make a folder")
    nowhere = tmp_path / "nowhere"
    nowhere.write_text("a file")
    assert ask(kernels, XDG_CACHE_HOME=str(nowhere)) == (20, 0)
    assert ask(kernels, XDG_CACHE_HOME=str(nowhere)) == (20, 0)
