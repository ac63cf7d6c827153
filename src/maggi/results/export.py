"""Results as comma-separated tables, one file per group."""

from __future__ import annotations

import csv
import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from maggi.model.errors import ModelError

from .contract import AXES, ENERGIES, RESIDUALS
from .results import Results

Array = NDArray[np.float64]
_ROWS_AT_A_TIME = 4096


def export_csv(results: Results, folder: str | Path, stem: str) -> list[Path]:
    """Write ``<stem>_time.csv``, ``_bodies``, ``_attachments``, ``_joints``, ``_energy`` and ``_residuals``.

    Every file starts with the time; its first line names each column with its unit, ``rod.origin.x [m]``.
    Numbers have 17 significant digits and so lose nothing. Groups that were not kept are left out, and so
    are nodal displacements, which belong in no such table.

    Returns
    -------
    The files written.

    Raises
    ------
    ModelError : the folder cannot be written to.
    """
    folder = Path(folder)
    groups = {
        "time": {"iterations [1]": results.iterations.astype(float)},
        "bodies": _bodies(results),
        "attachments": _attachments(results),
        "joints": _joints(results),
        "energy": _scalars(results, "energy", ENERGIES, "J"),
        "residuals": _scalars(results, "residuals", RESIDUALS, "1"),
    }
    written: list[Path] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for group, named in groups.items():
            if named:
                path = folder / f"{stem}_{group}.csv"
                _write(path, {"time [s]": results.time, **named})
                written.append(path)
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise ModelError(f"cannot write to {folder}: {reason}", remedy="choose another folder with -o") from error
    return written


def _bodies(results: Results) -> dict[str, Array]:
    named: dict[str, Array] = {}
    for name in results.bodies:
        body = results.body(name)
        if results.has(f"bodies/{name}/origin"):
            named |= _vector(f"{name}.origin", body.origin, "m")
            named |= _matrix(f"{name}.rotation", body.rotation)
        if results.has(f"bodies/{name}/modal"):
            named |= {f"{name}.modal.{k + 1} [m]": column for k, column in enumerate(body.modal.T)}
    return named


def _attachments(results: Results) -> dict[str, Array]:
    named: dict[str, Array] = {}
    for name in results.bodies:
        for at in results.body(name).attachments:
            if results.has(f"bodies/{name}/attachments/{at}/position"):
                attachment = results.body(name).attachment(at)
                named |= _vector(f"{name}.{at}.position", attachment.position, "m")
                named |= _matrix(f"{name}.{at}.rotation", attachment.rotation)
                named |= _vector(f"{name}.{at}.velocity", attachment.velocity, "m/s")
                named |= _vector(f"{name}.{at}.angular_velocity", attachment.angular_velocity, "rad/s")
    return named


def _joints(results: Results) -> dict[str, Array]:
    named: dict[str, Array] = {}
    for name in results.joints:
        if results.has(f"joints/{name}/force"):
            joint = results.joint(name)
            named |= _vector(f"{name}.position", joint.position, "m")
            named |= _vector(f"{name}.force", joint.force, "N")
            named |= _vector(f"{name}.torque", joint.torque, "N m")
            columns = zip(joint.units, joint.coordinate.T, strict=True)
            named |= {f"{name}.coordinate.{k + 1} [{unit}]": column for k, (unit, column) in enumerate(columns)}
    return named


def _scalars(results: Results, group: str, names: tuple[str, ...], unit: str) -> dict[str, Array]:
    return {f"{name} [{unit}]": results.series(f"{group}/{name}") for name in names if results.has(f"{group}/{name}")}


def _vector(name: str, values: Array, unit: str) -> dict[str, Array]:
    return {f"{name}.{axis} [{unit}]": values[:, i] for i, axis in enumerate(AXES)}


def _matrix(name: str, values: Array) -> dict[str, Array]:
    return {f"{name}.{a}{b} [1]": values[:, i, j] for i, a in enumerate(AXES) for j, b in enumerate(AXES)}


def _write(path: Path, named: dict[str, Array]) -> None:
    rows = len(next(iter(named.values())))
    values = list(named.values())
    with path.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerow(named)
        for first in range(0, rows, _ROWS_AT_A_TIME):
            block = np.column_stack([column[first : first + _ROWS_AT_A_TIME] for column in values])
            np.savetxt(file, block, fmt="%.17g", delimiter=",")
