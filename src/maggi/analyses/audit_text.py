"""An audit as text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from maggi.model.joint_kinds import JOINT_COORDINATES

from .audit_report import Audit, BodyReport, LiaisonReport, NodeSetReport, ReductionReport
from .freedoms import ElasticFreedoms, Freedom, Response
from .integrability import Integrability, PartIntegrability
from .mobility import Mobility, Redundant
from .remedies import Remedy

Array = NDArray[np.float64]


_RESPONSES = 6  # told of a motion at most
_KINDS = {"mesh": "elastic, full mesh", "reduced": "elastic, reduced", "ritz": "elastic, shape functions"}


def audit_text(audit: Audit) -> str:
    """The text of `maggi check`."""
    return "\n".join(_lines(audit))


def _lines(audit: Audit) -> Iterator[str]:
    yield audit.title or "Model without a title"
    yield f"extent {audit.size:.6g} m, gravity {_vector(np.array(audit.gravity), 1.0)} m/s²"
    yield from _section("Bodies", (line for body in audit.bodies for line in _body(body, audit.size)))
    yield from _section("Joints and drivers", _table(_liaison(one, audit.size) for one in audit.liaisons))
    yield from _section("Forces", _table((one.name, one.kind, " – ".join(one.on)) for one in audit.forces))
    yield from _section("Freedoms at the initial pose", _mobility(audit.mobility, audit.remedies))
    yield from _section("What moves", [*_motions(audit), *_elastic(audit.elastic, audit.mobility)])
    yield from _section("Rows that hold no position", _integrability(audit))
    notes = [*audit.notes]
    if audit.unused:
        notes.append(f"attachments that nothing uses: {', '.join(audit.unused)}")
    yield from _section("Notes", notes)


def _section(title: str, lines: Iterable[str]) -> Iterator[str]:
    listed = list(lines)
    if listed:
        yield ""
        yield title
        yield from (f"  {line}" for line in listed)


def _body(body: BodyReport, size: float) -> Iterator[str]:
    kind = _KINDS.get(body.kind, body.kind)
    frame = "" if body.frame == "floating" else ", prescribed frame"
    yield f"{body.name} ({kind}{frame}): {_count(body.freedoms, 'freedom')}"
    yield f"  mass {body.mass:.6g} kg, centre of mass {_vector(body.center_of_mass, size)} m (global)"
    moments = np.linalg.eigvalsh(body.inertia)
    yield f"  principal moments of inertia {', '.join(f'{moment:.4g}' for moment in moments)} kg m²"
    if body.bounding_box is not None:
        low, high = body.bounding_box
        cells = ", ".join(f"{count:,} {kind}" for kind, count in body.cells.items())
        yield f"  mesh: {_count(body.nodes, 'node')}, {cells}; from {_vector(low, size)} to {_vector(high, size)} m (body frame)"
    if body.reduction is not None:
        yield f"  reduction: {_reduction(body.reduction)}"
    yield from (f"  {line}" for line in _table(_node_set(one, size) for one in body.node_sets))
    rows = []
    for one in body.attachments:
        held = f"{_count(one.nodes, 'node')}, {one.coupling}" if one.coupling else ""
        rows.append((f"attachment {one.name}", f"at {_vector(one.position, size)} m (global)", held))
    yield from (f"  {line}" for line in _table(rows))


def _reduction(one: ReductionReport) -> str:
    highest = "" if one.highest is None else f" up to {one.highest:.5g} Hz"
    text = (
        f"{one.method}, {_count(one.freedoms, 'freedom')} to {_count(one.coordinates, 'coordinate')}: "
        f"{_count(one.modes, 'mode')} with the attachments held{highest}, {_count(one.interface, 'interface freedom')}"
    )
    if one.range is None:
        return text
    return f"{text}; together {one.range[0]:.5g} to {one.range[1]:.5g} Hz, free"


def _node_set(one: NodeSetReport, size: float) -> tuple[str, ...]:
    shape = one.kind
    if one.radius is not None:
        shape += f" of radius {one.radius:.5g} m"
    if one.axis is not None:
        role = {"cylinder": "axis", "line": "direction", "general": "longest along"}.get(one.kind, "normal")
        shape += f", {role} {_vector(one.axis, 1.0)}"
    center = "" if one.centroid is None else f"centroid {_vector(one.centroid, size)} m (body frame)"
    return f"set {one.name}", _count(one.nodes, "node"), center, shape


def _liaison(one: LiaisonReport, size: float) -> tuple[str, ...]:
    rows = _count(one.rows, "row")
    if one.drives is not None:
        joint, quantity, function = one.drives
        return one.name, "driver", f"{quantity} of {joint} = {function}", rows, ""
    place = f"at {_vector(one.position, size)} m" + ("" if one.axis is None else f", axis {_vector(one.axis, 1.0)}")
    return one.name, one.kind, f"{one.first} – {one.second}", rows, place


def _mobility(found: Mobility, remedies: tuple[Remedy, ...]) -> Iterator[str]:
    drivers = f", {found.drivers} of them drivers'" if found.drivers else ""
    yield f"{found.velocities:,} velocities without liaisons (a mesh counts with all its nodes)"
    yield f"− {found.rank:,} independent rows of {found.rows:,}{drivers}"
    yield f"= {_count(found.freedoms, 'true freedom')}"
    if found.position_freedoms != found.freedoms:
        yield f"of position {_count(found.position_freedoms, 'freedom')}, without the rows that hold velocities only"
    yield from _redundant("redundant rows, which do no harm", found.redundant)
    if found.velocities != found.rigid_velocities:
        yield (
            f"with every elastic body rigid: {found.rigid_velocities} velocities − {found.rigid_rank} independent rows "
            f"= mobility {found.rigid_mobility}"
        )
        if len(found.rigid_redundant) > len(found.redundant):
            yield from _redundant(
                "rows that elasticity alone keeps apart, so that stiffness decides how their forces share",
                found.rigid_redundant,
            )
    yield from (line for one in remedies for line in _remedy(one))
    if found.generic_rigid_mobility not in (None, found.rigid_mobility):
        yield f"in neighbouring poses the mobility of rigid bodies is {found.generic_rigid_mobility}"
    yield f"Grübler's count, which takes no notice of redundancy: {found.gruebler}"
    yield f"singular values of the rows on either side of the rank: {found.smallest_kept:.2g}, {found.largest_dropped:.1g}"
    yield f"condition of the basis S of what they admit: {found.conditioning:.2g}"


def _remedy(one: Remedy) -> Iterator[str]:
    if one.replacements:
        rows = "the redundant row" if one.redundant == 1 else f"the {one.redundant} redundant rows"
        yield f"{rows} of {', '.join(one.joints)} would go with {_and(map(str, one.replacements))}"


def _motions(audit: Audit) -> list[str]:
    """A line for each motion; six of one body are that body flying free."""
    of_bodies = Counter(one.name for one in audit.motions if one.of == "body")
    free = [name for name, count in of_bodies.items() if count == 6]
    plain = {one.name for one in audit.liaisons if len(JOINT_COORDINATES.get(one.kind, ())) == 1}
    rows = [_motion(one, plain) for one in audit.motions if one.of == "joint" or one.name not in free]
    return _table([*rows, *((f"{name} flies free", "6 freedoms") for name in free)])


def _motion(one: Freedom, plain: Collection[str]) -> tuple[str, str]:
    """The motion and what moves with it; plain: joints whose only coordinate need not be named."""
    driven = "" if one.driver is None else f", driven by {one.driver}"
    largest = sorted(one.responses, key=lambda response: -abs(response.rate))
    told = [_response(one, response, plain) for response in largest[:_RESPONSES]]
    if len(largest) > _RESPONSES:
        told.append(f"{len(largest) - _RESPONSES} more")
    return f"{one.name}: {one.quantity}{driven}", f"with it {', '.join(told)}" if told else ""


def _response(one: Freedom, response: Response, plain: Collection[str]) -> str:
    names = [] if response.name == one.name else [response.name]
    names += [] if response.name in plain else [response.quantity]
    unit = "" if response.unit == one.unit else f" {response.unit}/{one.unit}"
    return f"{' '.join(names)} {response.rate:.3g}{unit}"


def _elastic(bodies: tuple[ElasticFreedoms, ...], found: Mobility) -> Iterator[str]:
    for one in bodies:
        span = "" if one.range is None else f", {one.range[0]:.5g} to {one.range[1]:.5g} Hz when nothing holds it"
        yield f"{one.body} bends: {_count(one.freedoms, 'elastic freedom')}{span}"
    held = found.rank - found.rigid_rank
    if held:
        yield f"of the elastic freedoms the joints hold {held}"


def _integrability(audit: Audit) -> Iterator[str]:
    kinds = {one.name: one.kind for one in audit.liaisons}
    for part in audit.integrability:
        yield from _table((one.liaisons[0], kinds.get(one.liaisons[0], ""), _verdict(one)) for one in part.liaisons)
        if len(part.liaisons) > 1:
            yield f"together ({', '.join(part.together.liaisons)}): {_verdict(part.together)}"
        yield _reach(part)


def _verdict(one: Integrability) -> str:
    if one.tested == 0:
        return "not tested: the rows are not finite near the initial pose"
    size = f"|dα| {one.defect:.1g}"
    if one.rows == 0:
        return "follows from what the joints hold anyway"
    relations = _count(one.hidden, "relation") + " of positions"
    if one.integrable:
        return f"holonomic in disguise: {'integrates' if one.rows == 1 else 'integrate'} to {relations} ({size})"
    if one.hidden and one.complete:
        return f"nonholonomic in part: {relations} can be integrated ({size})"
    return f"nonholonomic ({size})"


def _reach(part: PartIntegrability) -> str:
    one = part.together
    least = "" if one.complete else "at least "
    return (
        f"{_count(one.positions, 'freedom')} of position, {one.velocities} of velocity; "
        f"{least}{one.reachable} of position can be reached"
    )


def _redundant(title: str, rows: tuple[Redundant, ...]) -> Iterator[str]:
    if not rows:
        return
    yield f"{title} (z: the joint's axis):"
    for one in rows:
        what = f"repeats rows of {', '.join(one.repeats)}" if one.repeats else "has nothing free to act on"
        yield f"  {one.row} {what}"


def _and(texts: Iterable[str]) -> str:
    *most, last = texts
    return f"{', '.join(most)} and {last}" if most else last


def _table(rows: Iterable[tuple[str, ...]]) -> list[str]:
    """Rows of texts as lines with aligned columns."""
    listed = list(rows)
    if not listed:
        return []
    widths = [max(len(cell) for cell in column) for column in zip(*listed, strict=True)]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in listed]
    return [line.rstrip() for line in lines]


def _vector(values: Array, size: float) -> str:
    """Components, without the dust that round-off leaves of what is zero beside `size`."""
    return "[" + ", ".join(f"{0.0 if abs(x) < 1e-12 * size else x:.6g}" for x in values.tolist()) + "]"


def _count(number: int, what: str) -> str:
    return f"{number:,} {what}" + ("" if number == 1 else "s")
