"""What a run says that cannot go on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from maggi.model.attachments import Attachment
from maggi.model.bodies import RitzBody, RitzTerms
from maggi.model.geometry import Pose
from maggi.model.joints import End, Joint
from maggi.model.model import Model
from maggi.stepping.stepper import Stepper
from maggi.system.build import build_system


def ritz(coupling: float) -> RitzBody:
    """One shape function along x, with ``m_O = (coupling, 0, 0)``: no field has more than √(mass · m) = 1."""
    square, zero = np.eye(1), np.zeros((1, 1))
    terms = RitzTerms(
        mass=1.0,
        S0=np.zeros(3),
        J0=np.eye(3),
        m=square,
        k=square,
        D=zero,
        m_O=np.array([[coupling, 0.0, 0.0]]),
        G=np.zeros((3, 1, 1)),
        H=np.zeros((3, 3, 1, 1)),
        s=np.zeros((3, 1)),
        s2=np.zeros((3, 3, 1)),
    )
    return RitzBody(terms, lambda points: np.zeros((len(points), 3, 1)), pose=Pose())


def stepper(coupling: float) -> Stepper:
    joint = Joint("weld", End("ground"), End("body", "root"))
    body = replace(ritz(coupling), attachments={"root": Attachment(at=(0.0, 0.0, 0.0))})
    return Stepper(build_system(Model(bodies={"body": body}, joints={"clamp": joint})), 0.9, 1e-8, 1.0, 1.0)


def test_impossible_ritz_constants_are_named() -> None:
    said = str(stepper(2.0).failure(0.5))
    assert "body 'body'" in said and "positive definite" in said and "0.5 s" in said


def test_otherwise_the_liaison_furthest_off_is_named() -> None:
    broken = stepper(0.5)
    broken.tried.now.vd[0] = 1.0
    assert "clamp" in str(broken.failure(0.5))


def test_a_motion_that_is_not_finite_is_said_to_be_so() -> None:
    broken = stepper(0.5)
    broken.tried.now.origin[:] = np.nan
    assert "no longer finite" in str(broken.failure(0.5))


def test_rows_without_a_value_of_a_finite_motion_name_their_joint() -> None:
    broken = stepper(0.5)
    broken.system.liaisons.frame[0] = np.nan
    assert str(broken.failure(0.5)) == "a function of 'clamp' has no finite value, at t = 0.5 s"
