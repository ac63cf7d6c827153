"""maggi: mechanisms whose parts bend, by Maggi's equations.

    model = maggi.load("slider_crank.yml")   # or build a maggi.Model
    results = maggi.run(model)               # or maggi.run(model, "slider_crank.h5")
    results.joint("crankpin").force          # (n, 3), N

Everything is imported when it is first asked for, so that ``import maggi`` itself is quick.
"""

from __future__ import annotations

import importlib
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _numba_cache

if TYPE_CHECKING:
    from .api import check, compare, linearize, load, ode, open, run  # noqa: A004
    from .model import (
        Attachment,
        BeamMesh,
        BoxMesh,
        BoxQuadrature,
        BoxSet,
        Cam,
        Coupler,
        CraigBampton,
        Damping,
        Distance,
        Driver,
        ElasticBody,
        End,
        ExpressionCurve,
        ExpressionShapes,
        ExpressionSurface,
        FileMesh,
        Formula,
        GivenMotion,
        Joint,
        JointCoordinate,
        KnifeEdge,
        LineQuadrature,
        Material,
        MeshError,
        Model,
        ModelError,
        ModelErrors,
        NamedSet,
        Outputs,
        Pfaffian,
        PfaffianFunction,
        PfaffianRow,
        Plane,
        PlaneSet,
        PointLoad,
        PointMass,
        PointOnCurve,
        PointOnSurface,
        Pose,
        RigidBody,
        RigidRunMotion,
        RitzBody,
        RitzIntegrals,
        RitzTerms,
        RollingDisc,
        RollingSphere,
        Section,
        Simulation,
        SimulationError,
        SplineCurve,
        SplineSurface,
        SpringDamper,
        TimeFunction,
        TorsionSpring,
        Velocity,
        expression,
        formula,
    )

__version__ = "0.1.0"

__all__ = [
    "Attachment",
    "BeamMesh",
    "BoxMesh",
    "BoxQuadrature",
    "BoxSet",
    "Cam",
    "Coupler",
    "CraigBampton",
    "Damping",
    "Distance",
    "Driver",
    "ElasticBody",
    "End",
    "ExpressionCurve",
    "ExpressionShapes",
    "ExpressionSurface",
    "FileMesh",
    "Formula",
    "GivenMotion",
    "Joint",
    "JointCoordinate",
    "KnifeEdge",
    "LineQuadrature",
    "Material",
    "MeshError",
    "Model",
    "ModelError",
    "ModelErrors",
    "NamedSet",
    "Outputs",
    "Pfaffian",
    "PfaffianFunction",
    "PfaffianRow",
    "Plane",
    "PlaneSet",
    "PointLoad",
    "PointMass",
    "PointOnCurve",
    "PointOnSurface",
    "Pose",
    "RigidBody",
    "RigidRunMotion",
    "RitzBody",
    "RitzIntegrals",
    "RitzTerms",
    "RollingDisc",
    "RollingSphere",
    "Section",
    "Simulation",
    "SimulationError",
    "SplineCurve",
    "SplineSurface",
    "SpringDamper",
    "TimeFunction",
    "TorsionSpring",
    "Velocity",
    "check",
    "compare",
    "expression",
    "formula",
    "linearize",
    "load",
    "ode",
    "open",
    "run",
]

_FUNCTIONS = ("check", "compare", "linearize", "load", "ode", "open", "run")

_numba_cache.configure(Path(__file__).resolve().parent)
# Idle threads of numba's pool otherwise spin, and on a busy machine parallel kernels wait for them: up to 8 ms a call.
os.environ.setdefault("GOMP_SPINCOUNT", "10000")

if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """Import a public name when it is first used (PEP 562)."""
        if name not in __all__:
            raise AttributeError(f"module 'maggi' has no attribute {name!r}")
        home = importlib.import_module("maggi.api" if name in _FUNCTIONS else "maggi.model")
        value = getattr(home, name)
        globals()[name] = value
        return value

    def __dir__() -> list[str]:
        """The public names, imported or not."""
        return sorted({*globals(), *__all__})
