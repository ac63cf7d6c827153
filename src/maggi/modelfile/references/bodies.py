"""Materials, node sets and frames of bodies."""

from __future__ import annotations

from ..schema.bodies import AnyBody, ElasticBodySection
from ..schema.frames import GivenFrameSection
from ..schema.meshes import BeamMeshSection, BoxMeshSection
from ..schema.mistakes import shown, suggestion
from .findings import Findings

BOX_SETS = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")
BEAM_SETS = ("start", "end")


def check_body(found: Findings, path: str, body: AnyBody) -> None:
    """Every name that a body refers to."""
    if isinstance(body, ElasticBodySection):
        if isinstance(body.material, str) and body.material not in found.document.materials:
            found.error(
                f"{path}.material",
                f"unknown material {shown(body.material)}",
                suggestion(body.material, found.document.materials, "known materials"),
            )
        _node_sets(found, path, body)
    if body.frame is not None:
        for place, name in enumerate(body.frame.held):
            if name not in body.attachments:
                found.error(
                    f"{path}.frame.held.{place}",
                    f"unknown attachment {shown(name)}",
                    suggestion(name, body.attachments, "attachments"),
                )
        if isinstance(body.frame, GivenFrameSection):
            for place, component in enumerate(body.frame.origin or ()):
                found.finite(f"{path}.frame.origin.{place}", component)
            if body.frame.angle is not None:
                found.finite(f"{path}.frame.angle", body.frame.angle)


def _node_sets(found: Findings, path: str, body: ElasticBodySection) -> None:
    """Sets of parametric meshes are known here; those of files when the mesh is read."""
    known = {BoxMeshSection: BOX_SETS, BeamMeshSection: BEAM_SETS}.get(type(body.mesh))
    if isinstance(body.mesh, BeamMeshSection | BoxMeshSection) and body.material is None:
        found.error(f"{path}.material", "missing key 'material'", "name a material, or give its keys")
    for name, attachment in body.attachments.items():
        if known and isinstance(attachment.nodes, str) and attachment.nodes not in known:
            found.error(
                f"{path}.attachments.{name}.nodes",
                f"unknown node set {shown(attachment.nodes)}",
                suggestion(attachment.nodes, known, "sets of this mesh"),
            )
