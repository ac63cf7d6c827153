"""Cross-checks of a document that is right in itself: do the names exist, do the parts fit together?"""

from __future__ import annotations

from ...model.errors import ModelError
from ..schema.document import Document
from .bodies import check_body
from .findings import Findings
from .forces import check_force
from .joints import JointChecks


def check_references(document: Document) -> list[ModelError]:
    """Every mistake, section by section; very long lists are cut."""
    found = Findings(document)
    joints = JointChecks(found)
    for name, body in document.bodies.items():
        if not found.enough:
            check_body(found, f"bodies.{name}", body)
    for name, joint in document.joints.items():
        if not found.enough:
            joints.check(name, joint)
    for name, force in document.forces.items():
        if not found.enough:
            check_force(found, f"forces.{name}", force)
    return found.errors
