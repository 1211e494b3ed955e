"""The discrete net over the fold, exact: every link one spacing long along the bent sheet, and no search in two planes.

A straight link that leaves the wing's node p, meets the crease at y and goes on straight on the spar ends at

    c(y) = spar_edge(y) + (spacing - ℓ) exp(i (φ + ψ(y))),   ℓ exp(i φ) = wing_edge(y) - p.

Whatever y, it is one spacing from p, so a node with one parent on the wing has one unknown and one equation, its
distance from the other parent; with both parents on the wing it has two of each. By Gauss's lemma c moves square to the
link: c' = i exp(i (φ + ψ)) (spacing φ' + (spacing - ℓ) ψ'). All other nodes are fourth corners of rhombi.

Rows enter the spar independently of one another, so all of them are found at once. The columns' drift is a recursion,
each column from the one before; it is solved by Newton's method on the whole crease, the curves c linearised together
and the recursion run through in order.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from meshdrape.errors import NetError
from meshdrape.theory.fold import ComplexArray, Fold
from meshdrape.theory.quadrature import FloatArray
from meshdrape.theory.sheet import FoldNet, Gamma, Sheet

_STEPS = 30


def discrete_net(fold: Fold, spacing: float, height: float, gamma: Gamma = 0.0, row_offset: float = 0.5) -> FoldNet:
    """The net of rods and pins over the fold, sheet laid undeformed on the wing, to round-off.

    Parameters are those of `characteristic_net`.

    Raises
    ------
    NetError
        If the crease turns so much within one spacing that a link cannot be laid across it; or if rows come back to the
        wing (`returning_rows`) and what they are off by there adds up to a spacing.
    """
    sheet = Sheet(fold, spacing, height, gamma, row_offset)
    entries = _entries(sheet)
    return sheet.net(entries, _drift(sheet, entries))


def _across(fold: Fold, spacing: float, p: ComplexArray, y: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Ends c of the links that leave the wing's nodes p and cross at y, and dc/dy."""
    rate, turn = fold.edge_rate(y), np.exp(1j * fold.psi(y))
    leg = fold.wing_edge(y) - p
    length = np.abs(leg)
    out = leg / length
    end = fold.spar_edge(y) + (spacing - length) * out * turn
    swing = spacing * (np.conj(out) * rate).imag / length + (spacing - length) * fold.psi_slope(y)
    return end, 1j * out * turn * swing


def _entries(sheet: Sheet) -> ComplexArray:
    """Nodes at which rows come over the crease: their left parent lies on the wing."""
    fold, d = sheet.fold, sheet.spacing
    i, r = sheet.entry_column, sheet.entry_row
    left = sheet.s[i - 1] + 1j * sheet.x[r]
    above = sheet.s[i] + 1j * sheet.x[r - 1]
    place = np.empty(len(i), dtype=np.complex128)
    top = ~sheet.on_spar[i, r - 1]
    # both parents on the wing: the two links meet
    a, b, y_a, y_b = left[top], above[top], sheet.entry_y[top], sheet.y[i[top]].copy()
    for _ in range(_STEPS):
        (end_a, rate_a), (end_b, rate_b) = _across(fold, d, a, y_a), _across(fold, d, b, y_b)
        gap = end_b - end_a
        area = (np.conj(rate_a) * rate_b).imag
        step_a, step_b = (np.conj(gap) * rate_b).imag / area, (np.conj(gap) * rate_a).imag / area
        done = _done(sheet, y_a, step_a) and _done(sheet, y_b, step_b)
        y_a, y_b = y_a + step_a, y_b + step_b
        if done:
            break
    else:
        raise _cannot(sheet, y_a)
    place[top] = _across(fold, d, a, y_a)[0]
    # further rows that enter in the same column hang from the one above, which is on the spar by now
    level = np.zeros(len(i), dtype=np.int64)
    if not top.all():
        for k in np.flatnonzero(~top):  # entries of a column are listed from the top
            level[k] = level[k - 1] + 1
    for depth in range(1, int(level.max(initial=0)) + 1):
        hung = np.flatnonzero(level == depth)
        p, parent, y = left[hung], place[hung - 1], sheet.entry_y[hung]
        for _ in range(_STEPS):
            end, rate = _across(fold, d, p, y)
            step = _onto_circle(end - parent, rate, d)
            done = _done(sheet, y, step)
            y = y + step
            if done:
                break
        else:
            raise _cannot(sheet, y)
        place[hung] = _across(fold, d, p, y)[0]
    return place


def _drift(sheet: Sheet, entries: ComplexArray) -> ComplexArray:
    """What the columns up to each add to a row that passes them, (n,) complex; 0 at the last.

    Summed from the right: what lies left of a row's crossing does not touch it, not even by round-off.
    """
    fold, d, rows = sheet.fold, sheet.spacing, len(sheet.x)
    on = sheet.on_spar
    first = np.where(on.any(axis=1), on.argmax(axis=1), rows)
    top = np.maximum(first[1:], first[:-1])  # the uppermost row with a link from column i - 1 to i on the spar
    crosses = (first[1:] == top) & (top < rows)  # its right node hangs from one on the wing
    column = np.flatnonzero(crosses) + 1
    parent = sheet.s[column] + 1j * sheet.x[top[column - 1] - 1]
    entered: list[list[tuple[int, complex]]] = [[] for _ in sheet.s]
    for i, r, p in zip(sheet.entry_column.tolist(), sheet.entry_row.tolist(), entries.tolist(), strict=True):
        entered[i].append((r, p))
    y = sheet.y[column].copy()
    for _ in range(_STEPS):
        ends, rates = _across(fold, d, parent, y)
        across = iter(zip(ends.tolist(), rates.tolist(), strict=True))
        along, steps = _chain(sheet, top.tolist(), crosses.tolist(), entered, across)
        step = np.array(steps)
        if _done(sheet, y, step):
            return np.append(-np.cumsum(along[::-1])[::-1], 0)
        # a column that has settled stays: its last digit must not depend on how long others take
        y = np.where(np.abs(step) < 1e-8 * d, y, y + step)
    raise _cannot(sheet, y)


def _chain(
    sheet: Sheet,
    top: list[int],
    crosses: list[bool],
    entered: list[list[tuple[int, complex]]],
    across: Iterator[tuple[complex, complex]],
) -> tuple[list[complex], list[float]]:
    """Row links of the columns in order, each from the one before, and by how much their crossings have to move.

    `across` gives the curve c(y) of each column whose link crosses the crease as a point and a tangent. Plain numbers:
    arrays of one would be ten times slower.
    """
    d, rows = sheet.spacing, len(sheet.x)
    start = sheet.ribbon().tolist()  # entry place of each row, less the sum of the links before it
    total, held_row, held = 0j, -1, 0j
    along, steps = [], []
    for i, (r, cross) in enumerate(zip(top, crosses, strict=True), start=1):
        link = 0j
        if r < rows:
            a = held if r == held_row else start[r] + total
            if cross:
                end, rate = next(across)
                # where the tangent of c(y) meets the circle about a
                away = end - a
                speed = rate.real**2 + rate.imag**2
                inward = away.real * rate.real + away.imag * rate.imag
                excess = away.real**2 + away.imag**2 - d * d
                root = inward * inward - speed * excess
                step = -excess / (inward + (root**0.5 if inward > 0 else -(root**0.5))) if root > 0 else np.nan
                steps.append(step)
                link = away + step * rate
            else:  # it hangs from a row that enters in this column: the fourth corner of two links on the spar
                b = next(p for row, p in entered[i] if row == r - 1)
                half = (b - a) / 2
                rest = d * d / (half.real**2 + half.imag**2) - 1
                link = half - 1j * half * (rest**0.5 if rest > 0 else np.nan)
            held_row, held = r, a + link
        along.append(link)
        total += link
        for row, p in entered[i]:
            start[row] = p - total
        if entered[i]:
            held_row, held = entered[i][0]
    return along, steps


def _onto_circle(away: ComplexArray, rate: ComplexArray, radius: float) -> FloatArray:
    """Step along the tangent `rate` from `away` to the circle about 0, the nearer way."""
    speed, inward = np.abs(rate) ** 2, (np.conj(away) * rate).real
    excess = np.abs(away) ** 2 - radius**2
    with np.errstate(invalid="ignore"):
        root = np.sqrt(inward**2 - speed * excess)
    return np.asarray(-excess / (inward + np.copysign(root, inward)))


def _done(sheet: Sheet, y: FloatArray, step: FloatArray) -> bool:
    """Whether Newton's method is at its end; it is quadratic, what is left after so small a step is round-off."""
    strayed = ~(np.abs(step) < 10 * sheet.spacing)
    if strayed.any():
        raise _cannot(sheet, y[strayed])
    return bool((np.abs(step) < 1e-8 * sheet.spacing).all())


def _cannot(sheet: Sheet, y: FloatArray) -> NetError:
    if len(sheet.exit_column):
        back = float(sheet.y[sheet.exit_column[0]])
        return NetError(
            f"rows come back from the spar to the wing from y = {back:.6g} on, and near y = {y[0]:.6g} the net no "
            "longer closes on a wing laid undeformed; start at the other end, or use characteristic_net"
        )
    return NetError(
        f"near y = {y[0]:.6g} no link of length {sheet.spacing:g} can be laid across the crease: it turns too fast for "
        "this spacing; lower the spacing"
    )
