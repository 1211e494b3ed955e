"""Whether the compiled kernels are at hand."""

from pathlib import Path


def is_compiled() -> bool:
    """Whether an earlier run left its compiled kernels in numba's cache, beside the sources or where numba was told."""
    import numba

    told = numba.config.CACHE_DIR
    folders = [Path(told)] if told else [Path(__file__).parent / "__pycache__"]
    return any(next(folder.rglob("sweep.sweep-*.nbc"), None) is not None for folder in folders)
