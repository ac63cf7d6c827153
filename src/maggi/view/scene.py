"""The mechanism as it stands before a run: bodies, attachments, joints, gravity."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from maggi.analyses.scene import Scene, SceneBody
from maggi.mesh.surface import surface_triangles
from maggi.results.results import Array

from .instants import distinct_points
from .joint_symbols import draw_joint
from .labels import Label, place_labels
from .outlines import COUPLERS, NOWHERE, ROLLING, bodies_at, coupled, draw_coupling, draw_outlines, outline_lines
from .parts import (
    GRAVITY_BOX,
    RIGID_COLORS,
    draw_beam,
    draw_gravity,
    draw_link,
    draw_points,
    draw_surface,
    draw_triad,
    prepare,
)
from .projection import Camera, axonometric, facing, upwards
from .style import new_figure, plain

WIDTH = 10.6  # inches
ELASTIC_COLOR = "#8fb8de"
JOINT_COLOR = "#a93226"
_NEAR = 0.01  # labels this close to each other, relative to the drawing, become one
_IN_A_PLANE = ("revolute", "driver")  # joints whose axis is the normal of a planar mechanism


def scene_figure(scene: Scene) -> Figure:
    """The mechanism in its plane, if its joint axes have a normal in common, and from above one corner."""
    points = np.concatenate([_points(scene), *_outlines(scene)])
    up = upwards(scene.gravity)
    size = float(np.ptp(points, axis=0).max()) or 1.0
    normal = _common_axis(scene)
    above = axonometric(vertical=up)
    cameras = [above] if normal is None else [facing(normal, up), above]
    limits = [(camera.flat(points).min(axis=0), camera.flat(points).max(axis=0)) for camera in cameras]
    heights = [
        0.85 * WIDTH * float(np.clip(np.divide(*(high - low + 0.15 * size)[::-1]), 0.25, 0.8)) for low, high in limits
    ]
    figure = new_figure(WIDTH, sum(heights) + 0.9, scene.title or "Model")
    panels = figure.subplots(len(cameras), 1, squeeze=False, height_ratios=heights)[:, 0]
    for axes, camera, (low, high) in zip(panels, cameras, limits, strict=True):
        prepare(axes, camera, low, high)
        _draw(axes, camera, scene, size)
        draw_triad(axes, camera)
        draw_gravity(axes, camera, scene.gravity)
    place_labels(panels[0], cameras[0], _labels(scene, _NEAR * size), GRAVITY_BOX)
    return figure


def _draw(axes: Axes, camera: Camera, scene: Scene, size: float) -> None:
    rigid = 0
    wheels = {joint.second.partition(".")[0] for joint in scene.joints if joint.kind in ROLLING}
    for body in sorted(scene.bodies, key=lambda body: float(camera.depth(body.origin))):
        if body.nodes is not None and body.cells is not None:
            nodes = _global(body, body.nodes)
            triangles = surface_triangles(body.cells)
            if len(triangles):
                draw_surface(axes, camera, nodes, triangles, np.tile(to_rgb(ELASTIC_COLOR), (len(triangles), 1)))
            beams = body.cells.get("beam2")
            if beams is not None and len(beams):
                draw_beam(axes, camera, nodes, beams, np.tile(to_rgb(ELASTIC_COLOR), (len(beams), 1)))
        else:
            color = RIGID_COLORS[rigid % len(RIGID_COLORS)]
            corners = _corners(scene, body, _NEAR * size)
            if len(corners) > 1 or body.name not in wheels:
                draw_link(axes, camera, corners, body.rotation, size, color)
            rigid += 1
    if scene.attachments:
        draw_points(axes, camera, np.stack([attachment.position for attachment in scene.attachments]))
    draw_outlines(axes, camera, _outlines(scene))
    places = {joint.name: joint.position for joint in scene.joints}
    for joint in scene.joints:
        if joint.kind in COUPLERS:
            draw_coupling(axes, camera, [places[name] for name in coupled(joint.first, joint.second)])
        draw_joint(axes, camera, joint, size, JOINT_COLOR)


def _corners(scene: Scene, body: SceneBody, near: float) -> Array:
    """The points that a rigid body's link joins: its attachments, its joints and its centre of mass, each once."""
    points = [attachment.position for attachment in scene.attachments if attachment.body == body.name]
    for joint in scene.joints:
        if body.name in bodies_at(joint.kind, joint.first, joint.second):
            points.append(joint.position)
        if joint.kind == "distance" and joint.outline is not None and body.name == joint.first.partition(".")[0]:
            points += list(_global(body, joint.outline.first))
    return np.stack(distinct_points([*points, body.center_of_mass], near))


def _outlines(scene: Scene) -> list[Array]:
    """The lines (n, 3) of all joints that have any."""
    poses = {body.name: (body.origin, body.rotation) for body in scene.bodies}
    lines = []
    for joint in scene.joints:
        if joint.outline is not None:
            ends = (poses.get(end.partition(".")[0], NOWHERE) for end in (joint.first, joint.second))
            lines += outline_lines(joint.kind, joint.outline, *ends)
    return lines


def _labels(scene: Scene, near: float) -> list[Label]:
    """One label for each place that has joints, for each other attachment, and for each body."""
    labels: list[Label] = []
    for joint in scene.joints:
        text = f"{plain(joint.name)} ({joint.kind})"
        place = next((label for label in labels if np.linalg.norm(label.point - joint.position) <= near), None)
        if place is None:
            labels.append(Label(joint.position, [text], JOINT_COLOR))
        else:
            place.lines.append(text)
    for attachment in scene.attachments:
        if all(np.linalg.norm(label.point - attachment.position) > near for label in labels):
            labels.append(Label(attachment.position, [plain(f"{attachment.body}.{attachment.name}")]))
    labels += [Label(_middle(scene, body, near), [plain(body.name)], bold=True) for body in scene.bodies]
    return labels


def _middle(scene: Scene, body: SceneBody, near: float) -> Array:
    points = _corners(scene, body, near) if body.nodes is None else _global(body, body.nodes)
    return np.asarray(0.5 * (points.min(axis=0) + points.max(axis=0)))


def _common_axis(scene: Scene) -> Array | None:
    """The normal of a planar mechanism: all turning joints turn about it, all sliding ones slide square to it."""
    turning = [joint.axis for joint in scene.joints if joint.axis is not None and joint.kind in _IN_A_PLANE]
    if not turning:
        return None
    sliding = [joint.axis for joint in scene.joints if joint.axis is not None and joint.kind == "prismatic"]
    normal = turning[0] / np.linalg.norm(turning[0])
    skew = [np.linalg.norm(np.cross(normal, axis)) for axis in turning] + [abs(normal @ axis) for axis in sliding]
    universal = any(joint.kind == "universal" for joint in scene.joints)
    return None if universal or max(skew) > 1e-3 else np.asarray(normal)


def _points(scene: Scene) -> Array:
    points = [body.center_of_mass[None] for body in scene.bodies]
    points += [_global(body, body.nodes) for body in scene.bodies if body.nodes is not None]
    points += [attachment.position[None] for attachment in scene.attachments]
    points += [joint.position[None] for joint in scene.joints]
    return np.concatenate(points) if points else np.zeros((1, 3))


def _global(body: SceneBody, points: Array) -> Array:
    return np.asarray(body.origin + points @ body.rotation.T)
