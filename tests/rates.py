"""How fast errors fall: the rates that tests of convergence assert, and the table they print where one is missed."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def rate(steps: ArrayLike, errors: ArrayLike) -> float:
    """Fitted slope of log(error) over log(step)."""
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def orders(errors: ArrayLike) -> NDArray[np.float64]:
    """Observed order from each error to the next, along the first axis; every step is half the one before."""
    errors = np.asarray(errors, dtype=np.float64)
    return np.asarray(np.log2(errors[:-1] / errors[1:]))


def table(steps: ArrayLike, errors: ArrayLike) -> str:
    """What is printed where a rate is missed."""
    lines = [f"{step:10.3e}  {error:10.3e}" for step, error in zip(steps, errors, strict=True)]
    return "\n".join(["", "      step       error", *lines, f"rate {rate(steps, errors):.3f}"])
