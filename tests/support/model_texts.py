"""Small mechanisms as model texts, for tests of what is told about them."""

PENDULUM = """\
maggi: 1
gravity: [0, 0, -9.81]
bodies:
  arm: {kind: rigid, mass: 2, center_of_mass: [0.5, 0, 0], inertia: [0, 0.1, 0.1], pose: {origin: [0, 0, 1]}}
joints:
  hinge: {type: revolute, between: [ground, arm], at: [0, 0, 1], axis: [0, 1, 0]}
"""

# A parallelogram-free four-bar in the x-z plane: three moving bars, four revolutes about y.
FOUR_BAR = """\
maggi: 1
bodies:
  crank: {kind: rigid, mass: 1, attachments: {end: {at: [0, 0, 1]}}}
  coupler: {kind: rigid, mass: 1, pose: {origin: [0, 0, 1]}, attachments: {start: {at: [0, 0, 0]}, end: {at: [3, 0, 1]}}}
  rocker: {kind: rigid, mass: 1, pose: {origin: [3, 0, 0]}, attachments: {end: {at: [0, 0, 2]}}}
joints:
  a: {type: revolute, between: [ground, crank], at: [0, 0, 0], axis: [0, 1, 0]}
  b: {type: revolute, between: [crank.end, coupler.start], axis: [0, 1, 0]}
  c: {type: revolute, between: [coupler.end, rocker.end], axis: [0, 1, 0]}
  d: {type: revolute, between: [ground, rocker], at: [3, 0, 0], axis: [0, 1, 0]}
"""

STEEL = "{density: 8000, young: 2e11, poisson: 0.3}"


def elastic(coupling="rigid", mesh="{box: {size: [2, 0.1, 0.1], cells: [2, 1, 1]}}", **keys):
    """A block on a hinge: two hex8 in a row, twelve nodes, attachments on the first and the last four."""
    more = "".join(f", {key}: {value}" for key, value in keys.items())
    return (
        f"maggi: 1\nbodies:\n  bar: {{kind: elastic, mesh: {mesh}, material: {STEEL}{more}, attachments: "
        f"{{a: {{nodes: x_min, coupling: {coupling}}}, b: {{nodes: x_max, coupling: {coupling}}}}}}}\n"
        "joints:\n  hinge: {type: revolute, between: [ground, bar.a], axis: [0, 1, 0]}\n"
    )


RIGID = "kind: rigid, mass: 1, inertia: [0.1, 0.1, 0.1]"
FLAT = "p: {type: planar, between: [ground, a], at: [0, 0, 0], axis: [0, 0, 1]}"


def model(bodies, *joints, **keys):
    """Bodies by their further keys and joints, one a line."""
    lines = ["maggi: 1", "bodies:", *(f"  {name}: {{{RIGID}{more}}}" for name, more in bodies.items())]
    return "\n".join([*lines, "joints:", *(f"  {joint}" for joint in joints), *(f"{k}: {v}" for k, v in keys.items())])


def ball(joint, **more):
    return model({"a": ", pose: {origin: [0.3, 0, 0.05]}", **more}, joint)


def blade(name, at, direction="[1, 0, 0]", body="a"):
    return f"{name}: {{type: knife-edge, between: [ground, {body}], at: {at}, direction: {direction}}}"


def translating(row, freedoms=3, *more):
    """A body that slides along x, y and, with three freedoms, z; p: its point."""
    last = (
        "prismatic, between: [b, c], at: [0, 0, 0], axis: [0, 0, 1]"
        if freedoms == 3
        else "weld, between: [b, c], at: [0, 0, 0]"
    )
    return model(
        {"a": "", "b": "", "c": ""},
        "x: {type: prismatic, between: [ground, a], at: [0, 0, 0], axis: [1, 0, 0]}",
        "y: {type: prismatic, between: [a, b], at: [0, 0, 0], axis: [0, 1, 0]}",
        f"z: {{type: {last}}}",
        *([f"row: {{type: pfaffian, between: {{p: c}}, rows: [{row}]}}"] if row else []),
        *more,
    )


TRAILERS = model(
    {"a": "", "b": "", "c": ""},
    FLAT,
    "h1: {type: revolute, between: [a, b], at: [-0.2, 0, 0], axis: [0, 0, 1]}",
    "h2: {type: revolute, between: [b, c], at: [-0.4, 0, 0], axis: [0, 0, 1]}",
    blade("k0", "[0, 0, 0]"),
    blade("k1", "[-0.4, 0, 0]", body="b"),
    blade("k2", "[-0.6, 0, 0]", body="c"),
)
ROLLING_DISC = "{type: rolling-disc, between: [ground, a], radius: 0.05, axis: [0, 1, 0]}"
ROLLING_SPHERE = "{type: rolling-sphere, between: [ground, a], radius: 0.05}"

# name: (model, freedoms of position, of velocity, reachable), of all rows without a position together
VELOCITY_ROWS = {
    # rolling without slip: Bloch, "Nonholonomic mechanics and control", §§1.4, 1.9; a sphere reaches every place and
    # attitude, with spinning and without
    "disc": (ball(f"r: {ROLLING_DISC}"), 5, 3, 5),
    "sphere": (ball(f"r: {ROLLING_SPHERE}"), 5, 3, 5),
    "sphere that does not spin": (
        model({"a": ", pose: {origin: [0, 0, 0.05]}"}, f"r: {ROLLING_SPHERE}", "s: {type: pfaffian, between: {k: a}, rows: [k.w.z]}"),
        5, 2, 5,
    ),
    "sphere on a turntable": (
        ball("r: {type: rolling-sphere, between: [t, a], radius: 0.05}", t=", frame: {axis: [0, 0, 1], angle: 3*t + t**2}"), 5, 3, 5,
    ),
    # a disc that stays in a vertical plane: x = r φ
    "wheel in a plane": (
        model({"a": ", pose: {origin: [0, 0, 0.05]}"}, "p: {type: planar, between: [ground, a], at: [0, 0, 0.05], axis: [0, 1, 0]}", f"r: {ROLLING_DISC}"),
        2, 1, 1,
    ),
    # Chaplygin's sleigh
    "sleigh": (model({"a": ""}, FLAT, blade("k", "[0.1, 0, 0]")), 3, 2, 3),
    "blade in space": (model({"a": ""}, blade("k", "[0.1, 0, 0]")), 6, 5, 6),
    # two skates side by side repeat each other; behind each other they hold the heading, across they hold a centre of rotation
    "skates side by side": (model({"a": ""}, FLAT, blade("k", "[0, 0.1, 0]"), blade("l", "[0, -0.1, 0]")), 3, 2, 3),
    "skates in tandem": (model({"a": ""}, FLAT, blade("k", "[0.1, 0, 0]"), blade("l", "[-0.1, 0, 0]")), 3, 1, 1),
    "crossing skates": (model({"a": ""}, FLAT, blade("k", "[0.1, 0, 0]"), blade("l", "[-0.1, 0, 0]", "[0.6, 0.8, 0]")), 3, 1, 1),
    # x dy + y dx + dz is exact; every form in two variables has an integrating factor, dz − y dx, Darboux' normal form, none
    "exact form": (translating("p.x*p.v.y + p.y*p.v.x + p.v.z"), 3, 2, 2),
    "two variables": (translating("(1 + p.x)*p.v.y - p.y*p.v.x", 2), 2, 1, 1),
    "two of three variables": (translating("(1 + p.x)*p.v.y - p.y*p.v.x"), 3, 2, 2),
    "contact form": (translating("p.v.z - p.y*p.v.x"), 3, 2, 3),
    # Martinet's form is integrable nowhere but looks so on y = 0, where it is tried first
    "Martinet's form": (translating("p.v.z - p.y**2*p.v.x"), 3, 2, 3),
    # time is a coordinate: a row may be nonholonomic by it alone, a driven speed integrates
    "ẏ = t ẋ": (translating("p.v.y - t*p.v.x", 2), 2, 1, 2),
    "ẏ = sin 100 t": (translating("p.v.y - sin(100*t)", 2), 2, 1, 1),
    "driven speed": (translating("", 3, "m: {type: driver, joint: x, speed: 3*t**2}"), 3, 2, 2),
    # Engel's growth 2, 3, 4 and the truck with trailers, 2, 3, 4, 5: brackets of brackets (Laumond, "Robot motion planning")
    "car": (
        model(
            {"a": "", "b": ""}, FLAT, "h: {type: revolute, between: [a, b], at: [1, 0, 0], axis: [0, 0, 1]}",
            blade("k", "[0, 0, 0]"), blade("l", "[1, 0, 0]", body="b"),
        ),
        4, 2, 4,
    ),
    "car with two trailers": (TRAILERS, 5, 2, 5),
}  # fmt: skip
