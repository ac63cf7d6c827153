"""Every liaison of the library, placed at random between two bodies of a workshop."""

from __future__ import annotations

import numpy as np
from workshop import across, direction, matrix, vector

from maggi.model import (
    GROUND,
    Cam,
    Coupler,
    Distance,
    Driver,
    ExpressionCurve,
    ExpressionSurface,
    JointCoordinate,
    KnifeEdge,
    Pfaffian,
    PfaffianFunction,
    PfaffianRow,
    Plane,
    PointOnCurve,
    PointOnSurface,
    RollingDisc,
    RollingSphere,
    SplineCurve,
    SplineSurface,
    expression,
    formula,
)
from maggi.model.joints import POSE

# joints


def _axial(kind, **keys):
    def add(shop, first, second):
        return shop.join(kind, first, second, axis=vector(direction(shop.rng)), **keys)

    return add


def _plain(kind):
    return lambda shop, first, second: shop.join(kind, first, second)


def universal(shop, first, second):
    x = direction(shop.rng)
    return shop.join("universal", first, second, axes=(vector(x), vector(across(shop.rng, x))))


def bent_shafts(shop, first, second):
    z = direction(shop.rng)
    other = z + 0.4 * across(shop.rng, z)
    return shop.join("constant-velocity", first, second, axes=(vector(z), vector(other)))


def screw(shop, first, second):
    pitch = float(shop.rng.choice([-1.0, 1.0]) * shop.rng.uniform(0.1, 0.5))
    return shop.join("screw", first, second, axis=vector(direction(shop.rng)), pitch=pitch)


# liaisons of two points


def rod(shop, first, second):
    ends = [shop.attachment(name, shop.place(name)) for name in (first, second)]
    return shop.add("rod", Distance(*ends))


def driven_rod(shop, first, second):
    p = shop.place(first)
    q = p + 0.7 * direction(shop.rng)
    ends = shop.attachment(first, p), shop.attachment(second, q)
    return shop.add("rod", Distance(*ends, expression("0.7 + 0.3*t + 0.5*t**2")))


def _curve(shop):
    a, b, c = shop.rng.uniform(0.2, 0.6, 3)
    x, y, z = (
        formula(text, ("s",), a=float(a), b=float(b), c=float(c))
        for text in ("a*cos(s)", "b*sin(s) + 0.1*s**2", "c*s + 0.2*sin(2*s)")
    )
    s = 0.4
    point = np.array([a * np.cos(s), b * np.sin(s) + 0.1 * s**2, c * s + 0.2 * np.sin(2 * s)])
    return ExpressionCurve(x, y, z, (-2.0, 3.0)), point


def _carrier(shop, first):
    """The end that carries a curve or a surface, whose frame is that of its body."""
    return shop.end(first, shop.to_global(first, np.zeros(3)))


def curve(shop, first, second):
    track, point = _curve(shop)
    place = shop.to_global(first, point)
    return shop.add(
        "curve", PointOnCurve(_carrier(shop, first), shop.end(second, place), track, shop.at(second, place))
    )


def spline(shop, first, second):
    angles = np.linspace(0.0, 2.0 * np.pi, 9)[:-1]
    points = np.column_stack([0.6 * np.cos(angles), 0.4 * np.sin(angles), 0.1 * np.cos(2.0 * angles)])
    place = shop.to_global(first, points[2])
    track = SplineCurve(tuple(map(vector, points)), closed=True)
    return shop.add(
        "spline", PointOnCurve(_carrier(shop, first), shop.end(second, place), track, shop.at(second, place))
    )


def surface(shop, first, second):
    point = 0.5 * direction(shop.rng) + [0.3, 0.2, 0.1]
    x, y, z = (float(v) for v in point)
    level = x**2 + 2.0 * y**2 + 0.5 * z**2 + 0.3 * np.sin(2.0 * x) * z
    F = formula("x**2 + 2*y**2 + 0.5*z**2 + 0.3*sin(2*x)*z - level", ("x", "y", "z"), level=float(level))
    place = shop.to_global(first, point)
    return shop.add(
        "surface",
        PointOnSurface(_carrier(shop, first), shop.end(second, place), ExpressionSurface(F), shop.at(second, place)),
    )


def height_field(shop, first, second):
    x, y = np.linspace(-1.0, 1.0, 6), np.linspace(-1.2, 1.2, 5)
    z = 0.2 * np.sin(2.0 * x)[:, None] + 0.15 * np.cos(2.0 * y)
    place = shop.to_global(first, [x[3], y[2], z[3, 2]])
    field_of = SplineSurface(vector(x), vector(y), matrix(z))
    return shop.add(
        "field", PointOnSurface(_carrier(shop, first), shop.end(second, place), field_of, shop.at(second, place))
    )


def _cam(shop, first, second, **keys):
    """An elliptic cam in the plane normal to z of its body; the follower's point on it or `keys["radius"]` away."""
    profile = ExpressionCurve(
        formula("0.4*cos(s)", ("s",)),
        formula("0.25*sin(s)", ("s",)),
        formula("0*s", ("s",)),
        (0.0, 6.283185307179586),
        True,
    )
    s = 0.7
    point, tangent = (
        np.array([0.4 * np.cos(s), 0.25 * np.sin(s), 0.0]),
        np.array([-0.4 * np.sin(s), 0.25 * np.cos(s), 0.0]),
    )
    normal = np.cross(tangent, [0.0, 0.0, 1.0]) / np.linalg.norm(tangent)
    R = np.eye(3) if first == GROUND else np.array(shop.bodies[first].pose.rotation)
    if "face" in keys:
        keys["face"] = vector(R @ normal)
        place = point + 0.05 * tangent
    else:
        place = point + keys["radius"] * normal
    place = shop.to_global(first, place)
    return shop.add(
        "cam",
        Cam(
            _carrier(shop, first),
            shop.end(second, place),
            profile,
            vector(R[:, 2]),
            at=shop.at(second, place),
            **keys,
        ),
    )


def roller(shop, first, second):
    return _cam(shop, first, second, radius=0.1)


def edge_follower(shop, first, second):
    return _cam(shop, first, second, radius=0.0)


def face_follower(shop, first, second):
    return _cam(shop, first, second, face=None)


# contacts without slip


def disc(shop, first, second):
    rng = shop.rng
    n, radius = direction(rng), float(rng.uniform(0.1, 0.4))
    u = across(rng, n) + float(rng.uniform(-0.8, 0.8)) * n
    u /= np.linalg.norm(u)
    centre = shop.place(second)
    down = -(n - (n @ u) * u)
    foot = centre + radius * down / np.linalg.norm(down)
    return shop.add(
        "disc",
        RollingDisc(
            shop.end(first, foot),
            shop.end(second, centre),
            radius,
            vector(u),
            Plane(vector(foot), vector(n)),
            shop.at(second, centre),
        ),
    )


def sphere(shop, first, second):
    rng = shop.rng
    n, radius = direction(rng), float(rng.uniform(0.1, 0.4))
    centre = shop.place(second)
    foot = centre - radius * n
    place = foot if shop.is_elastic(first) else foot + 0.3 * across(rng, n)
    return shop.add(
        "sphere",
        RollingSphere(
            shop.end(first, place),
            shop.end(second, centre),
            radius,
            Plane(vector(place), vector(n)),
            shop.at(second, centre),
        ),
    )


def blade(shop, first, second):
    n = direction(shop.rng)
    along = across(shop.rng, n)
    place = shop.place(second)
    return shop.add(
        "blade",
        KnifeEdge(shop.end(first, place), shop.end(second, place), vector(along), vector(n), shop.at(second, place)),
    )


# relations of coordinates


def _driver(kind, quantity, text):
    def add(shop, first, second):
        joint = _axial(kind)(shop, first, second)
        return shop.add("motor", Driver(joint, quantity, expression(text)))

    return add


def _pair(kinds, quantities, text, rates=False, kind="coupler"):
    """A relation between the coordinates of two joints that lead from the first body over a third to the second."""

    def add(shop, first, second):
        middle = shop.rigid()
        names = [_axial(kinds[0])(shop, first, middle), _axial(kinds[1])(shop, middle, second)]
        coordinates = {
            letter: JointCoordinate(joint, q) for letter, joint, q in zip("ab", names, quantities, strict=True)
        }
        return shop.add("relation", Coupler(kind, coordinates, formula(text, ("t", "a", "b")), rates))

    return add


# rows of the user's own


def pfaffian(shop, first, second):
    ends = {"p": shop.attachment(first, shop.place(first)), "q": shop.attachment(second, shop.place(second))}
    names = ("t", *(f"{end}.{part}" for end in ends for part in POSE))
    rows = (
        PfaffianRow(
            {
                ("q", "v.x"): formula("q.r11 + 0.3*p.y*t", names),
                ("q", "v.y"): formula("q.r21*p.r11", names),
                ("p", "v.z"): formula("1 + 0.5*q.x**2", names),
                ("q", "w.z"): formula("0.2*q.r33", names),
            },
            formula("0.1*t + 0.05*p.x", names),
        ),
        PfaffianRow({("p", "w.x"): formula("1", names), ("q", "w.y"): formula("cos(q.z)", names)}),
    )
    return shop.add("pfaffian", Pfaffian(ends, rows))


def _own_rows(t, position, rotation):
    A = np.zeros((1, 2, 6))
    A[0, 0, :3] = rotation[1, :, 0]
    A[0, 1, :3] = np.cross(position[0] - position[1], [0.0, 0.0, 1.0]) + [1.0, 0.0, t]
    A[0, 1, 3:] = 0.1 * rotation[0, 2]
    return A, np.array([0.2 * np.sin(t) + 0.1 * position[1, 0]])


def own_function(shop, first, second):
    ends = {"p": shop.attachment(first, shop.place(first)), "q": shop.attachment(second, shop.place(second))}
    return shop.add("function", PfaffianFunction(ends, 1, _own_rows))


HOLONOMIC = {
    "revolute": _axial("revolute"),
    "prismatic": _axial("prismatic"),
    "cylindrical": _axial("cylindrical"),
    "planar": _axial("planar"),
    "spherical": _plain("spherical"),
    "weld": _plain("weld"),
    "free": _plain("free"),
    "universal": universal,
    "constant-velocity": _axial("constant-velocity"),
    "bent-shafts": bent_shafts,
    "screw": screw,
    "rod": rod,
    "driven-rod": driven_rod,
    "curve": curve,
    "spline-curve": spline,
    "surface": surface,
    "height-field": height_field,
    "cam-roller": roller,
    "cam-edge": edge_follower,
    "cam-face": face_follower,
    "angle-driver": _driver("revolute", "angle", "2*t + 0.5*sin(3*t)"),
    "angle-driver-cylindrical": _driver("cylindrical", "angle", "t**2 + t"),
    "angle-driver-planar": _driver("planar", "angle", "1.5*t"),
    "displacement-driver": _driver("prismatic", "displacement", "0.2*t + 0.3*t**2"),
    "gear": _pair(("revolute", "revolute"), ("angle", "angle"), "b - (-2.5)*a", kind="gear"),
    "rack": _pair(("revolute", "prismatic"), ("angle", "displacement"), "b - 0.2*a", kind="rack"),
    "coupler": _pair(("cylindrical", "prismatic"), ("angle", None), "b - 0.3*sin(a) + 0.1*a*b - 0.2*t"),
}
NONHOLONOMIC = {
    "disc": disc,
    "sphere": sphere,
    "knife-edge": blade,
    "speed-driver": _driver("revolute", "speed", "1 + 2*t"),
    "speed-driver-prismatic": _driver("prismatic", "speed", "0.5*cos(t)"),
    "coupler-of-rates": _pair(("revolute", "prismatic"), (None, None), "b - 0.4*cos(t)*a + 0.2*t", rates=True),
    "pfaffian": pfaffian,
    "function": own_function,
}
LIAISONS = {**HOLONOMIC, **NONHOLONOMIC}
"""Every kind of liaison: ``add(shop, first, second)`` places it at random between two bodies and returns its name."""
