"""Reading a model file: text ─► places and values ─► checked document ─► `Model`."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ..model.bodies import ElasticBody
from ..model.errors import ModelError, ModelErrors
from ..model.expression import Parameter, check_variable_name, resolve_parameters
from ..model.meshes import FileMesh
from ..model.model import Model
from .build import build_model
from .compose import MAX_CHARACTERS, compose
from .overrides import apply_overrides
from .placement import check_placement
from .references import check_references
from .schema.document import Document
from .schema.mistakes import MAX_MISTAKES, Context, Located, to_model_errors
from .source import SourceMap


def read(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> tuple[Model, SourceMap]:
    """The model of a YAML or JSON file.

    overrides : texts ``key=value`` that replace single values, such as ``simulation.step=1e-6``.

    Returns the model and the places of its values, which `SourceMap.locate` puts into errors that come later.
    Raises ModelErrors with every mistake found, in the order of the file, each with line and column; ModelError
    where the file cannot be read or is not YAML.
    """
    file = Path(path)
    return read_text(_contents(file), name=str(path), folder=str(file.parent), overrides=overrides)


def read_text(
    text: str, *, name: str = "model", folder: str = ".", overrides: Sequence[str] = ()
) -> tuple[Model, SourceMap]:
    """As `read`, from a text; `name` stands for the file in messages, `folder` is where mesh paths start."""
    root = compose(text, name)
    apply_overrides(root, overrides)
    source = SourceMap(root)
    document = _validate(root.plain(), source, folder)
    _raise_located([Located(error) for error in check_references(document)], source)
    record = text + "".join(f"\n# --set {' '.join(override.split())}" for override in overrides)
    model = build_model(document, record, folder)
    _raise_located([Located(error) for error in [*_missing_meshes(model), *check_placement(model)]], source)
    return model, source


def _contents(file: Path) -> str:
    try:
        if file.is_dir():
            raise ModelError("this is a folder, not a model file", file=str(file), remedy="name the .yml file in it")
        with file.open("rb") as stream:
            raw = stream.read(4 * MAX_CHARACTERS + 1)
    except FileNotFoundError:
        raise ModelError("no such file", file=str(file), remedy="check the path") from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise ModelError(f"cannot be read: {reason}", file=str(file)) from None
    if len(raw) > 4 * MAX_CHARACTERS:
        raise ModelError(
            f"more than {4 * MAX_CHARACTERS} bytes", file=str(file), remedy="keep meshes in their own files"
        )
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        column = error.start - raw.rfind(b"\n", 0, error.start)
        raise ModelError(
            f"byte {raw[error.start]:#04x} is not UTF-8",
            file=str(file),
            line=line,
            column=column,
            remedy="save as UTF-8",
        ) from None


def _validate(data: Any, source: SourceMap, folder: str) -> Document:
    try:
        context = Context(_parameters(data), folder)
    except ModelErrors as errors:
        # Expressions elsewhere need the parameters: their mistakes come first, alone.
        _raise_located([Located(error, _names_badly(error)) for error in errors.errors], source)
        raise
    try:
        return Document.model_validate(data, context=context)
    except ValidationError as found:
        _raise_located(to_model_errors(found, data, context), source, more=found.error_count() - MAX_MISTAKES)
        raise


def _parameters(data: Any) -> dict[str, Parameter]:
    given = data.get("parameters") if isinstance(data, dict) else None
    return resolve_parameters(given) if isinstance(given, dict) else {}


def _names_badly(error: ModelError) -> bool:
    """Whether a parameter's name, not its value, is what is wrong."""
    try:
        check_variable_name(error.path.partition(".")[2])
    except ModelError:
        return True
    return False


def _raise_located(found: Sequence[Located], source: SourceMap, more: int = 0) -> None:
    if found:
        errors = [source.locate(each.error, key=each.at_key) for each in found]
        errors.sort(key=lambda error: (error.line, error.column))
        if more > 0:
            errors.append(ModelError(f"and {more} more mistakes", file=source.root.place.file))
        raise ModelErrors(errors)


def _missing_meshes(model: Model) -> list[ModelError]:
    errors = []
    for name, body in model.bodies.items():
        if isinstance(body, ElasticBody) and isinstance(body.mesh, FileMesh):
            path = Path(model.folder, body.mesh.path)
            try:
                there = path.is_file()
            except (OSError, ValueError):
                there = False
            if not there:
                errors.append(
                    ModelError(
                        f"no mesh file '{path}'",
                        path=f"bodies.{name}.mesh.file",
                        remedy="paths start at the model file's folder",
                    )
                )
    return errors
