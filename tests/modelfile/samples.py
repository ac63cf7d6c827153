"""Model texts that the tests start from."""

from __future__ import annotations

# The example of the format's contract, with what is still to come left out (a reduction, geometric stiffening).
CONTRACT = """\
maggi: 1
title: Slider-crank with an elastic connecting rod
gravity: [0, 0, -9.81]
parameters: {speed: "1500 rpm"}
materials:
  steel: {density: 7850, young: 210 GPa, poisson: 0.3, damping: {mass: 0, stiffness: 1e-6}}
bodies:
  crank:
    kind: rigid
    mass: 0.4
    center_of_mass: [0.05, 0, 0]
    inertia: [1e-4, 4e-4, 4e-4]              # about the centre of mass: diagonal or 3x3
    pose: {origin: [0, 0, 0], rotation: {axis: [0, 1, 0], angle: "30 deg"}}
    velocity: {linear: [0, 0, 0], angular: [0, 0, 0]}
    attachments: {pin: {at: [0.1, 0, 0]}}    # body frame
  rod:
    kind: elastic
    mesh: {file: rod.msh, unit: mm}
    material: steel
    reduction: none
    geometric_stiffening: false
    attachments:
      big_end:   {nodes: big_end, coupling: rigid}
      small_end: {nodes: small_end, coupling: average}
joints:
  bearing: {type: revolute, between: [ground, crank], at: [0, 0, 0], axis: [0, 1, 0]}
  crankpin: {type: revolute, between: [crank.pin, rod.big_end], axis: [0, 1, 0]}
  motor: {type: driver, joint: bearing, angle: "speed*t"}
forces:
  spring: {type: spring-damper, between: [crank.pin, [0, 0, 0.3]], stiffness: 1e4, damping: 10, length: 0.2}
outputs: {every: 10, quantities: [bodies, joints]}
simulation: {duration: 0.1, step: 1e-5, method: generalized-alpha, rho_inf: 0.9, tolerance: 1e-8, start: quasi-static}
"""

# Every kind of section that the contract's example does not show. No mesh file is needed.
EVERYTHING = """\
maggi: 1
title: One of each
gravity: [0, 0, "-9.81 m/s^2"]
parameters:
  length: 500 mm
  half: length/2
  n: 4
materials:
  steel: {density: "7.85 g/cm^3", young: 210 GPa, poisson: 0.3}
bodies:
  beam:
    kind: elastic
    mesh: {beam: {length: length, elements: n, section: {rectangle: {y: 10 mm, z: 20 mm}}}}
    material: steel
    frame: {origin: [0, 0, "0.1*sin(t)"], axis: [0, 0, 2], angle: "2*t", held: [root]}
    attachments:
      root: {nodes: start}
      tip: {nodes: {box: [[0.4, -1, -1], [1, 1, 1]]}, coupling: average, point_masses: [{mass: 1, offset: [0, 0.1, 0], inertia: [1e-3, 1e-3, 1e-3]}]}
  block:
    kind: elastic
    mesh: {box: {size: [1, 0.1, 0.1], cells: [n, 1, 1], cell: hex20}}
    material: {density: 1000, young: 1e9, poisson: 0.4, damping: {stiffness: 1 ms}}
    frame: {motion: rigid-run, held: [left]}
    attachments:
      left: {nodes: x_min}
      plane: {nodes: {plane: {point: [half, 0, 0], normal: [1, 0, 0], tolerance: 1 mm}}}
  tube:
    kind: elastic
    mesh: {beam: {length: 1, elements: 3, section: {circle: {diameter: 0.02}}}}
    material: steel
    pose: {origin: [0, 1, 0], rotation: [[0, -1, 0], [1, 0, 0], [0, 0, 1]]}
    attachments: {a: {nodes: start}, b: {nodes: end}}
  profile:
    kind: elastic
    mesh: {beam: {length: 1, elements: 3, section: {area: 1e-4, Iy: 1e-8, Iz: 2e-8, J: 3e-8, ky: 0.8, kz: 0.4}}}
    material: steel
    attachments: {a: {nodes: start}, b: {nodes: end}}
  disc: {kind: rigid, mass: 1, inertia: [[2, 0.1, 0], [0.1, 2, 0], [0, 0, 3]], attachments: {rim: {at: [0.1, 0, 0], point_masses: [{mass: 2 g}]}}}
  table: {kind: rigid, mass: 1, frame: {axis: [0, 0, 1], angle: "t"}}
  slab: {kind: rigid, mass: 1}
joints:
  a: {type: cylindrical, between: [ground, disc], at: [0, 0, 0], axis: [0, 0, 1]}
  b: {type: prismatic, between: [disc, slab], at: [0, 0, 0], axis: [1, 0, 0]}
  c: {type: spherical, between: [disc.rim, tube.a]}
  d: {type: universal, between: [tube.b, profile.a], axes: [[1, 0, 0], [0, 1, 0]]}
  e: {type: planar, between: [ground, profile.b], axis: [0, 0, 1]}
  f: {type: weld, between: [slab, beam.tip]}
  turn: {type: driver, joint: a, angle: "2*t"}
  lift: {type: driver, joint: a, displacement: "0.1*smoothstep(t, 0, 0.5)"}
  push: {type: driver, joint: b, speed: "1 m/s"}
forces:
  load: {type: force, on: beam.tip, value: [0, "10 N", "sin(t)"], frame: body}
  twist: {type: torque, on: slab, value: [0, 0, "3 N m"]}
  coil: {type: torsion-spring, joint: a, stiffness: "5 N m/rad", damping: 0.1, angle: "10 deg"}
  strut: {type: spring-damper, between: [disc.rim, slab], stiffness: "5 N/mm"}
outputs: {quantities: all}
simulation: {duration: "100 ms", step: "0.1 ms", start: undeformed}
"""
# The connecting rod of Simeon's crank (CASES C1 (b)): lateral sin(πx/l), sin(2πx/l), longitudinal 4ξ(1−ξ), 2ξ²−ξ.
SIMEON_ROD = """\
maggi: 1
parameters: {l: 0.30, h: 0.008, E: 0.2e12, FK: E*h*h/l, K11: "FK*pi**4/24*(h/l)**2"}
bodies:
  rod:
    kind: ritz
    shapes:
      x: [0, 0, "4*x/l*(1 - x/l)", "2*(x/l)**2 - x/l"]
      y: ["sin(pi*x/l)", "sin(2*pi*x/l)", 0, 0]
      z: [0, 0, 0, 0]
    integrals:
      density: 7870
      line: {length: l, area: h*h, order: 24}
      stiffness:
        - [K11, 0, 0, 0]
        - [0, 16*K11, 0, 0]
        - [0, 0, 16/3*FK, -8/3*FK]
        - [0, 0, -8/3*FK, 7/3*FK]
      J0: [[1e-6, 0, 0], [0, 0.0045339259, 0], [0, 0, 0.0045339259]]
    initial: {coordinates: [0, 0, 0.103339863e-4, 0.169327969e-4], rates: [0, 0, 0, 0]}
    attachments: {pin: {at: [0, 0, 0]}, piston: {at: [l, 0, 0]}}
joints:
  pin: {type: revolute, between: [ground, rod.pin], axis: [0, 0, 1]}
"""

# Every kind of joint that EVERYTHING does not have. Nothing is said of how they work together.
LIBRARY = """\
maggi: 1
title: The joint library
parameters: {w: 1.2 m, base: 2.5 m, n: 3}
bodies:
  shaft: {kind: rigid, mass: 1, inertia: [1, 1, 1], attachments: {hub: {at: [0.1, 0, 0]}}}
  wheel: {kind: rigid, mass: 1, inertia: [1, 1, 1], pose: {origin: [0, 1, 0.3]}, attachments: {rim: {at: [0, 0, 0.3]}}}
  lever: {kind: rigid, mass: 1, inertia: [1, 1, 1], attachments: {tip: {at: [0, 0.1, 0]}}}
  cam: {kind: rigid, mass: 1, inertia: [1, 1, 1], pose: {rotation: {axis: [1, 0, 0], angle: 90 deg}}}
  sled: {kind: rigid, mass: 1, inertia: [1, 1, 1], attachments: {front: {at: [0.2, 0, 0]}}}
  ball: {kind: rigid, mass: 1, inertia: [1, 1, 1]}
joints:
  crank: {type: revolute, between: [ground, shaft], at: [0, 0, 0], axis: [0, 0, 1]}
  rocker: {type: cylindrical, between: [ground, wheel], at: [0, 1, 0], axis: [0, 0, 1]}
  slider: {type: prismatic, between: [ground, lever], at: [0, 0, 0], axis: [1, 0, 0]}
  loose: {type: free, between: [ground, ball], at: [0, 0, 0]}
  inline: {type: constant-velocity, between: [shaft, wheel], at: [0, 0, 0], axis: [0, 0, 1]}
  bent: {type: constant-velocity, between: [shaft.hub, wheel], axes: [[0, 0, 1], [0, 1, 1]]}
  nut: {type: screw, between: [shaft, lever.tip], axis: [0, 0, 1], pitch: 5 mm}
  feed: {type: driver, joint: nut, angle: 10*t}
  mesh: {type: gear, joints: [crank, rocker.angle], ratio: -n}
  bar: {type: rack, joints: [crank, slider], radius: 20 mm}
  chain: {type: belt, joints: [crank, rocker], radii: [0.1, 0.05], crossed: true}
  steering: {type: coupler, joints: {a: crank, b: rocker.angle}, relation: tan(a) - tan(b) - w/base*tan(a)*tan(b)}
  balance: {type: coupler, joints: {crank: 2, slider: -1/n}}
  sides: {type: coupler, joints: {rocker.displacement: 1, rocker.angle: n}, rates: true}
  speeds: {type: coupler, joints: {a: crank, d: rocker.displacement}, rates: true, relation: 2*(a - d)*cos(t) + 0.1*t}
  rod: {type: distance, between: [shaft.hub, lever.tip]}
  string: {type: distance, between: [ball, [0, 0, 2 m]], length: "2 + 0.1*sin(t)"}
  slot: {type: point-on-curve, between: [shaft, ball], at: [0, 0, 0], curve: {points: [[0, 0], [10 cm, 0.02, 0], [0.2, 0, 0.1]]}}
  loop: {type: point-on-curve, between: [ground, lever.tip], curve: {points: [[0, 0.1], [1, 0], [0, 1]], closed: true}}
  helix: {type: point-on-curve, between: [ground, lever], at: [1, 0, 0], curve: {x: cos(s), y: sin(s), z: 0.1*s, s: [0, 720 deg]}}
  hill: {type: point-on-surface, between: [ground, lever.tip], surface: {z: "0.1*sin(x)*y"}}
  bowl: {type: point-on-surface, between: [shaft, ball], at: [0, 0, -1], surface: {implicit: x**2 + y**2 + z**2 - 1}}
  ground: {type: point-on-surface, between: [ground, sled.front], surface: {x: [-1, 0, 1], y: [-1, 1], z: [[0, 0], [1 mm, 0.01], [0, 0]]}}
  lift: {type: cam, between: [cam, lever.tip], axis: [0, 1, 0], profile: {radius: "0.02 + 0.005*cos(s)"}, roller: 4 mm}
  press: {type: cam, between: [cam, lever.tip], axis: [0, 1, 0], profile: {x: 0.02*cos(s), y: 0.02*sin(s), s: [0, 2*pi]}, face: [1, 0, 1]}
  trace: {type: cam, between: [cam, lever], at: [0.01, 0, 0], axis: [0, -1, 0], profile: {points: [[0.01, 0, 1], [0, 0.02, 1], [-0.01, 0, 1], [0, -0.02, 1]]}}
  tyre: {type: rolling-disc, between: [ground, wheel], radius: 0.3, axis: [0, 1, 0]}
  roll: {type: rolling-sphere, between: [shaft, ball], radius: 10 cm, at: [0, 0, 0.3], plane: {point: [0, 0, 0.2], normal: [0, 0, 2]}}
  skate: {type: knife-edge, between: [ground, sled.front], direction: [1, 0, 0]}
  blade: {type: knife-edge, between: [ground, sled], at: [0, 0, 0], direction: [0, 0, 1], normal: [0, 1, 0]}
  side: {type: pfaffian, between: {blade: sled.front, g: ground}, rows: [{blade.v.x: -sin(0.1)*blade.r11, blade.v.y: blade.r11, constant: 0.1*t}]}
  rows: {type: pfaffian, between: [sled, ball], rows: [first.v.y*first.r11 - first.v.x*first.r21 + 0.1*t, 2*(first.w.z - second.w.z)/n]}
forces:
  coil: {type: torsion-spring, joint: nut, stiffness: 1}
simulation: {duration: 1, step: 1 ms}
"""
