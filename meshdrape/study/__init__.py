"""Questions answered by draping many times."""

from meshdrape.study.convergence import Convergence, refine
from meshdrape.study.forecast import Forecast, forecast

__all__ = ["Convergence", "Forecast", "forecast", "refine"]
