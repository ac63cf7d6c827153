"""Frozen descriptions of mechanisms: what the user says, in SI units, before anything is computed."""

from .attachments import Attachment, BoxSet, NamedSet, NodeSelection, PlaneSet, PointMass
from .bodies import (
    Body,
    ElasticBody,
    FrameMotion,
    GivenMotion,
    RigidBody,
    RigidRunMotion,
    RitzBody,
    RitzTerms,
)
from .errors import MeshError, ModelError, ModelErrors, SimulationError
from .expression import constant, expression
from .forces import Force, PointLoad, SpringDamper, TorsionSpring
from .functions import TimeFunction
from .geometry import IDENTITY, Matrix, Pose, Vector, Velocity
from .joints import GROUND, Driver, End, Joint, Liaison
from .materials import Damping, Material
from .meshes import BeamMesh, BoxMesh, FileMesh, MeshSource, Section
from .model import Model
from .shapes import BoxQuadrature, ExpressionShapes, LineQuadrature, RitzIntegrals
from .simulation import QUANTITIES, Outputs, Simulation

__all__ = [
    "GROUND",
    "IDENTITY",
    "QUANTITIES",
    "Attachment",
    "BeamMesh",
    "Body",
    "BoxMesh",
    "BoxQuadrature",
    "BoxSet",
    "Damping",
    "Driver",
    "ElasticBody",
    "End",
    "ExpressionShapes",
    "FileMesh",
    "Force",
    "FrameMotion",
    "GivenMotion",
    "Joint",
    "Liaison",
    "LineQuadrature",
    "Material",
    "Matrix",
    "MeshError",
    "MeshSource",
    "Model",
    "ModelError",
    "ModelErrors",
    "NamedSet",
    "NodeSelection",
    "Outputs",
    "PlaneSet",
    "PointLoad",
    "PointMass",
    "Pose",
    "RigidBody",
    "RigidRunMotion",
    "RitzBody",
    "RitzIntegrals",
    "RitzTerms",
    "Section",
    "Simulation",
    "SimulationError",
    "SpringDamper",
    "TimeFunction",
    "TorsionSpring",
    "Vector",
    "Velocity",
    "constant",
    "expression",
]
