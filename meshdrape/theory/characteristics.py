"""Section 6 as a solver: rows and columns are characteristics, the net on two flat sheets in closed form.

A column carries the turn ψ of the place where it crossed the crease, a row that of its own crossing, or γ where it
starts on the left-most ribbon. On the spar the row links of a column are therefore the same for all rows, and the
column links of a row the same for all columns: a node is where its row entered plus the drift of the columns,

    P(y0, y1) = spar_edge(y0) + H(y1) - H(y0),   H(y) = ∫ exp(i ψ) ds_w

for a row that crosses at y0 and a column that crosses at y1. Nothing is solved but where a straight row meets the
crease curve, g_s(y0) = x. The shear of a cell is the angle between its sides. Since d spar_edge - dH = i exp(i ψ) dx,
the column link of a cell has the mean of the turn over the width of its row, the row link that over its column.

Section 6.3 draws the crease straight at the scale of a cell; here it is the curve itself, sampled at the lattice: the
limit of the discrete net, which `discrete_net` builds exactly. A cell that straddles the crease is no plane rhombus in
either; it has no single shear and belongs to neither region.

One thing does not fade with the spacing. A left-most ribbon that is not laid straight on over the edge, γ ≠ ψ(0), has a
kink at the corner: its link there is shorter as the crow flies than along the cloth, and the first column is turned by
a fixed angle for it (0.2 degrees for a kink of ten). With the crease straight at the corner that too is closed form.

The report swaps its regions I and II between sections 3.4 and 6.4; here they are called by what feeds their rows.
"""

from __future__ import annotations

import numpy as np

from meshdrape.theory.fold import Fold
from meshdrape.theory.sheet import FoldNet, Gamma, Sheet


def characteristic_net(
    fold: Fold, spacing: float, height: float, gamma: Gamma = 0.0, row_offset: float = 0.5
) -> FoldNet:
    """The net of a sheet laid undeformed on the wing, by the construction of section 6.

    Nodes differ from the discrete net's by terms of second order in the spacing, cell shear likewise but near a crease
    that leaves the rows tangentially.

    Parameters
    ----------
    fold : Fold
        ``fold.swapped()`` for a sheet laid on the spar first, ``fold.reversed()`` for one that starts at the tip.
    spacing, height : float
        In the unit of the fold; height of the spar below the crease.
    gamma : float or "free"
        Turn of the left-most spar ribbon, rad; "free" = straight on over the crease.
    row_offset : float
        First row of the wing at this many spacings from the corner.
    """
    sheet = Sheet(fold, spacing, height, gamma, row_offset)
    y0 = sheet.entry_y
    place = fold.spar_edge(y0) - fold.drift(y0) + sheet.drift[sheet.entry_column]
    drift = sheet.drift.copy()
    drift[0] = drift[1] - (drift[1] - drift[0]) * _turn_at_the_kink(sheet)
    return sheet.net(place, drift)


def _turn_at_the_kink(sheet: Sheet) -> complex:
    """By what the first column's row links are turned, a unit number: fourth corner of the cell at the corner.

    Spar unfolded into the wing's plane about the crease's tangent, the corner at 0: the ribbon's first node a, the
    wing's node b one column on and one row up, and their common neighbour c at one spacing from both.
    """
    d, below = sheet.spacing, sheet.corner - float(sheet.x[sheet.on_spar[0].argmax()])
    kink = sheet.gamma - float(sheet.fold.psi(0.0))
    a = -1j * below * np.exp(1j * kink)
    half = (d + 1j * (d - below) - a) / 2
    link = half - 1j * half * np.sqrt(max(d * d / abs(half) ** 2 - 1, 0.0))
    return complex(link / abs(link))
