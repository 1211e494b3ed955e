"""Charts in the plane: one style for all, drawn without a screen, returned as PNG.

Matplotlib is imported only when something is drawn, and never its global state (`pyplot`): a figure is an object that
belongs to whoever made it. Colours of lines are those of Okabe and Ito (Color Universal Design, 2008), which can be
told apart with any colour vision; colours of shear are the package's own.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike

from meshdrape.output.colour import shear_colour

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import ListedColormap
    from matplotlib.figure import Figure

BLUE: Final = "#0072B2"
GREEN: Final = "#009E73"
ORANGE: Final = "#E69F00"
VERMILION: Final = "#D55E00"
PURPLE: Final = "#CC79A7"
INK: Final = "#1C1E24"
FAINT: Final = "#646870"
GRID: Final = "#E3E5E9"
PAPER: Final = "#FFFFFF"

DPI: Final = 180
_STYLE: Final[dict[str, Any]] = {
    "font.family": "DejaVu Sans",  # comes with matplotlib, so that every machine draws the same
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9,
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "text.color": INK,
    "xtick.color": FAINT,
    "ytick.color": FAINT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "lines.linewidth": 1.6,
    "lines.solid_capstyle": "round",
    "figure.facecolor": PAPER,
    "savefig.facecolor": PAPER,
}


@contextmanager
def styled() -> Iterator[None]:
    """The style of all charts, as long as the block lasts."""
    try:
        import matplotlib
    except ImportError as error:
        from meshdrape.errors import missing_library

        raise missing_library(error) from None
    with matplotlib.rc_context(_STYLE):
        yield


def new_figure(width: float, height: float) -> Figure:
    """A figure of a size in inches whose parts make room for one another."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def png(figure: Figure, dpi: int = DPI, *, palette: bool = True) -> bytes:
    """The figure as PNG, with a palette of 256 colours unless it shades: a chart needs no more, at half the size."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image

    figure.set_dpi(dpi)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return _packed(Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3]), palette=palette)


def packed(picture: bytes, width: int) -> bytes:
    """A PNG made no wider than so many pixels, in a palette of 256 colours, dithered to keep its shades."""
    from PIL import Image

    image = Image.open(io.BytesIO(picture)).convert("RGB")
    if image.width > width:
        image = image.resize((width, round(image.height * width / image.width)), Image.Resampling.LANCZOS)
    palette = image.quantize(256, Image.Quantize.MEDIANCUT, kmeans=4)
    entries = np.array(palette.getpalette(), dtype=np.uint8).reshape(-1, 3)
    entries[entries.min(axis=1) > 250] = 255  # paper stays white
    palette.putpalette(entries.tobytes())
    return _packed(image.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG), palette=False)


def _packed(image: Any, *, palette: bool) -> bytes:
    from PIL import Image

    out = io.BytesIO()
    if palette:
        image = image.quantize(256, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    image.save(out, "PNG", optimize=True)
    return out.getvalue()


def mark_locking(ax: Axes, locking_angle: float) -> None:
    """Draw the locking angle, rad, across a chart of shear in degrees."""
    lock = np.degrees(locking_angle)
    ax.axhline(lock, color=VERMILION, linewidth=1.0, label=f"locking, {lock:g}°")


def shear_map(locking_angle: float, largest: float) -> ListedColormap:
    """The package's colours of shear from 0 to the largest, rad, as a colour map for matplotlib."""
    from matplotlib.colors import ListedColormap

    return ListedColormap(shear_colour(np.linspace(0.0, largest, 512), locking_angle) / 255.0)


def equal_scale(axes: Axes) -> None:
    """Lengths along both axes alike, no grid: for a drawing rather than a chart."""
    axes.set_aspect("equal")
    axes.grid(visible=False)


def segments(axes: Axes, lines: ArrayLike, colour: str, width: float, **options: Any) -> Any:
    """Add polylines (n, k, 2), NaN where one is broken, as one collection; returns it."""
    from matplotlib.collections import LineCollection

    pieces = np.asarray(lines, dtype=np.float64)
    collection = LineCollection(list(pieces), colors=colour, linewidths=width, capstyle="round", **options)
    axes.add_collection(collection, autolim=False)
    return collection
