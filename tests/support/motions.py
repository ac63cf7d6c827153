"""Bodies with random shape functions, smooth random motions of a system, and derivatives along them."""

from collections.abc import Callable

import numpy as np

from maggi.bodies.attachment_kernels import attachment_motion
from maggi.bodies.tables import AttachmentState, MotionState
from maggi.elements.moving_frame import inertia_constants
from maggi.liaisons.kernels import evaluate_rows
from maggi.liaisons.tables import ROTATION, ROTATION_SECOND, ROTATION_VECTOR, TRANSLATION, LiaisonState
from maggi.linalg.rotations import rotation_matrix
from maggi.model.attachments import Attachment, NamedSet
from maggi.model.bodies import ElasticBody, RigidBody, RitzBody, RitzTerms
from maggi.model.geometry import Pose
from maggi.model.materials import Material
from maggi.model.meshes import BoxMesh
from maggi.system.dense import new_attachments, new_rows

# Central differences of order eight on nine points: the first's error is h⁸/630 of the ninth derivative, 1e-10 in the
# fastest motions of the tests; at twice the step it is 200 times that.
POINTS = np.arange(-4, 5)
FIRST = np.array([3.0, -32.0, 168.0, -672.0, 0.0, 672.0, -168.0, 32.0, -3.0]) / 840.0
SECOND = np.array([-9.0, 128.0, -1008.0, 8064.0, -14350.0, 8064.0, -1008.0, 128.0, -9.0]) / 5040.0
STEP = 0.01


def derivative(f, t=0.0, h=STEP):
    """First derivative of an array-valued function of time."""
    return np.tensordot(FIRST, np.array([f(t + k * h) for k in POINTS]), 1) / h


def second_derivative(f, t=0.0, h=2.0 * STEP):
    """Second derivative of an array-valued function of time."""
    return np.tensordot(SECOND, np.array([f(t + k * h) for k in POINTS]), 1) / h**2


def axial(matrix):
    """The vector of the skew part of a (3, 3) matrix."""
    return 0.5 * np.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]])


def random_rotation(rng):
    return rotation_matrix(rng.normal(size=3))


def random_pose(rng):
    return Pose(tuple(rng.normal(size=3)), tuple(tuple(row) for row in random_rotation(rng)))


def positive(rng, n):
    """A random symmetric positive definite matrix."""
    X = rng.normal(size=(n, n))
    return X @ X.T + n * np.eye(n)


def rigid_body(rng, **attachments):
    """A rigid body with a general inertia tensor, at a random pose."""
    return RigidBody(
        float(rng.uniform(1.0, 2.0)),
        tuple(rng.normal(size=3)),
        tuple(tuple(row) for row in positive(rng, 3)),
        random_pose(rng),
        attachments={name: Attachment(at=at) for name, at in attachments.items()},
    )


def ritz_body(rng, count=3, **attachments):
    """A Ritz body of mass points, whose shape functions and rotations are random linear functions of position."""
    N0, N1 = 0.3 * rng.normal(size=(3, count)), 0.3 * rng.normal(size=(3, 3, count))
    T0, T1 = rng.normal(size=(3, count)), rng.normal(size=(3, 3, count))
    points, weights = rng.normal(size=(9, 3)), rng.uniform(0.1, 0.3, 9)

    def shapes(x):
        return N0 + np.einsum("pj,jia->pia", x, N1)

    c = inertia_constants(shapes(points), points, weights)
    terms = RitzTerms(
        float(c.mass), c.S0, c.J0, c.m, positive(rng, count), positive(rng, count), c.m_O, c.G, c.H, c.s, c.s2
    )
    return RitzBody(
        terms,
        shapes,
        lambda x: T0 + np.einsum("pj,jia->pia", x, T1),
        pose=random_pose(rng),
        attachments={name: Attachment(at=at) for name, at in attachments.items()},
    )


def mesh_body(rng, first="p", second="s"):
    """A box of two hexahedra with a rigid attachment at its start and an averaged one at its end."""
    return ElasticBody(
        BoxMesh((0.4, 0.2, 0.1), (2, 1, 1)),
        Material(density=1000.0, young=1e7, poisson=0.3),
        random_pose(rng),
        attachments={
            first: Attachment(nodes=NamedSet("x_min")),
            second: Attachment(nodes=NamedSet("x_max"), coupling="average"),
        },
    )


def attachments_at(system, state: MotionState) -> AttachmentState:
    """Motion of all attachments."""
    out = new_attachments(system.bodies.attachment_body.size)
    attachment_motion(system.bodies, state, out)
    return out


def rows_at(system, state: MotionState, t: float, previous=None) -> LiaisonState:
    """Values of all liaison rows."""
    out = new_rows(system)
    if previous is not None:
        out.previous[:] = previous
    evaluate_rows(system.liaisons, system.bodies, state, attachments_at(system, state), out, t)
    return out


class Motion:
    """A smooth motion of all bodies: cubic in time for origins, rotation vectors and elastic coordinates.

    Velocities and accelerations follow by differences from the poses, so that they share nothing with the kernels.
    `follow` makes the pose of one body another function of time.
    """

    def __init__(self, system, seed: int, elastic: float = 0.3):
        rng = np.random.default_rng(seed)
        b, n = system.bodies.kind.size, system.coordinates
        self.system = system
        self._origin = rng.normal(size=(4, b, 3))
        self._start = np.array([random_rotation(rng) for _ in range(b)])
        self._turn = rng.normal(size=(3, b, 3))
        self._elastic = elastic * rng.normal(size=(4, n))
        self._followed: dict[int, Callable] = {}

    def follow(self, body: int, pose: Callable) -> None:
        """Let a body have the pose (origin, rotation) that a function of time gives."""
        self._followed[body] = pose

    def pose(self, body: int, t: float):
        """Origin and rotation of a body's frame."""
        if body == 0:
            return np.zeros(3), np.eye(3)
        if body in self._followed:
            return self._followed[body](t)
        powers = t ** np.arange(4) / [1.0, 1.0, 2.0, 6.0]
        return powers @ self._origin[:, body], self._start[body] @ rotation_matrix(powers[1:] @ self._turn[:, body])

    def elastic(self, t: float):
        return t ** np.arange(4) / [1.0, 1.0, 2.0, 6.0] @ self._elastic

    def at_rest(self, t: float) -> MotionState:
        """Positions at time t, without velocities."""
        poses = [self.pose(b, t) for b in range(self.system.bodies.kind.size)]
        n = self.system.coordinates
        return MotionState(
            np.array([r for r, _ in poses]),
            np.array([R for _, R in poses]),
            self.elastic(t),
            np.zeros(n),
            np.zeros(n),
        )

    def state(self, t: float = 0.0) -> MotionState:
        """Positions, velocities (t, ė) and their rates at time t."""
        state = self.at_rest(t)
        state.v[:], state.vd[:] = derivative(self.elastic, t), second_derivative(self.elastic, t)
        offset = self.system.bodies.offset
        for b in range(1, self.system.bodies.kind.size):
            o, R = offset[b], state.rotation[b]
            spin = R.T @ derivative(lambda s, b=b: self.pose(b, s)[1], t)
            v = R.T @ derivative(lambda s, b=b: self.pose(b, s)[0], t)
            a = R.T @ second_derivative(lambda s, b=b: self.pose(b, s)[0], t)
            w = axial(spin)
            state.v[o : o + 3], state.v[o + 3 : o + 6] = v, w
            # Rᵀr̈ = v̇ + ω × v, and RᵀR̈ = ε̃ + ω̃ω̃, of which the last is symmetric
            state.vd[o : o + 3] = a - np.cross(w, v)
            state.vd[o + 3 : o + 6] = axial(R.T @ second_derivative(lambda s, b=b: self.pose(b, s)[1], t))
        return state


def relative_motion(kind, values):
    """Translation (3,) and rotation (3, 3) of a joint's second end in its first's axes for given coordinates.

    Translations along the first's axes, then turns in the order of the coordinates: by their definition in the model.
    """
    shift, turn, vector = np.zeros(3), np.eye(3), np.zeros(3)
    for (what, axis), value in zip(kind.coordinates, values, strict=True):
        if what == TRANSLATION:
            shift[axis] = value
        elif what in (ROTATION, ROTATION_SECOND):
            turn = turn @ rotation_matrix(value * np.eye(3)[axis])
        elif what == ROTATION_VECTOR:
            vector[axis] = value
    return shift, turn @ rotation_matrix(vector)


def hold_together(motion: Motion, joint: int, kind, coordinates: Callable, moved: int) -> None:
    """Let the rigid body at end `moved` (0 or 1) of a joint move so that the joint's coordinates are as given."""
    table, bodies = motion.system.liaisons, motion.system.bodies
    ends = (int(table.joint[joint, 0]), int(table.joint[joint, 1]))
    frames = (table.frame[joint, 0], table.frame[joint, 1])
    body = int(bodies.attachment_body[ends[moved]])

    def pose(t):
        other = attachments_at(motion.system, _without(motion, body, t))
        shift, turn = relative_motion(kind, coordinates(t))
        end = ends[1 - moved]
        axes = other.rotation[end] @ frames[1 - moved]
        if moved == 1:
            position, axes = other.position[end] + axes @ shift, axes @ turn
        else:
            axes = axes @ turn.T
            position = other.position[end] - axes @ shift
        R = axes @ frames[moved].T
        return position - R @ bodies.attachment_point[ends[moved]], R

    motion.follow(body, pose)


def _without(motion: Motion, body: int, t: float) -> MotionState:
    """Positions of all bodies but one, which is anywhere."""
    followed = motion._followed.pop(body, None)
    state = motion.at_rest(t)
    if followed is not None:
        motion._followed[body] = followed
    return state
