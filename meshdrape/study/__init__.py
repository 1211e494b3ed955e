"""Questions answered by draping many times."""

from meshdrape.study.convergence import Convergence, refine

__all__ = ["Convergence", "refine"]
