"""The scripts of ``cad/`` stand beside the package, not in it: put their folder on the import path."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "cad"))
