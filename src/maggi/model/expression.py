"""The expression language of model files: a text over floats, compiled to a postfix program.

    numbers   + - * / ** ( )   pi   parameters   t (in functions of time)
    sin cos tan asin acos atan atan2(y, x) exp log sqrt abs min max
    smoothstep(x, x0, x1): 0 up to x0, 1 from x1 on, between them the quintic 6s⁵ − 15s⁴ + 10s³, s = (x − x0)/(x1 − x0)

Angles are in radians, `log` is natural, `min` and `max` take one or more arguments. `smoothstep` is twice
continuously differentiable: a driver that uses it starts and stops without a jump in acceleration.

The text is parsed with the standard library's `ast` and every node is checked against a short list; nothing of it
is ever handed to the interpreter, lengths are capped, and all arithmetic is in double precision (``9**9**9`` is an
overflow, not a wait). Constant parts are computed at once, so that a mistake in them is reported here.
"""

from __future__ import annotations

import ast
import keyword
import math
import re
import warnings
from collections.abc import Mapping, Sequence
from graphlib import CycleError, TopologicalSorter
from typing import NamedTuple

import numpy as np

from .errors import ModelError, ModelErrors
from .functions import Formula, TimeFunction
from .operations import BINARY, MAX_STACK, ON_ARRAYS, Operation, evaluate
from .suggest import nearest
from .units import Dimension, parse_quantity

MAX_LENGTH = 1000
MAX_DEPTH = 100
MAX_PARAMETERS = 1000

TIME = ("t",)

_OPERATORS: dict[type[ast.operator], Operation] = {
    ast.Add: Operation.ADD,
    ast.Sub: Operation.SUBTRACT,
    ast.Mult: Operation.MULTIPLY,
    ast.Div: Operation.DIVIDE,
    ast.Pow: Operation.POWER,
}
_SYMBOLS = {
    Operation.ADD: "+",
    Operation.SUBTRACT: "-",
    Operation.MULTIPLY: "*",
    Operation.DIVIDE: "/",
    Operation.POWER: "**",
    Operation.NEGATE: "-",
}
_ONE_ARGUMENT = {
    "sin": Operation.SIN,
    "cos": Operation.COS,
    "tan": Operation.TAN,
    "asin": Operation.ASIN,
    "acos": Operation.ACOS,
    "exp": Operation.EXP,
    "log": Operation.LOG,
    "sqrt": Operation.SQRT,
    "abs": Operation.ABS,
}
_MANY_ARGUMENTS = {"min": Operation.MINIMUM, "max": Operation.MAXIMUM}
FUNCTIONS = frozenset({*_ONE_ARGUMENT, *_MANY_ARGUMENTS, "atan", "atan2", "smoothstep"})
RESERVED = FUNCTIONS | {"pi", "t"}

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")

Instruction = tuple[Operation, float]


class Program(NamedTuple):
    """A compiled expression: operation codes and, where an operation has one, its constant."""

    codes: tuple[int, ...]
    values: tuple[float, ...]


class Parameter(NamedTuple):
    """A resolved parameter in SI units; `dimension` where it was given as number and unit."""

    value: float
    dimension: Dimension | None = None


def expression(text: str | float, **parameters: str | float) -> TimeFunction:
    """A function of time from a text (or a number), with values for the parameters it names.

    Example: ``expression("speed*t*smoothstep(t, 0, 0.01)", speed="1500 rpm")``. A parameter is a number in SI
    units, a text ``number unit``, or an expression in other parameters.

    Raises ModelError for anything that is not an expression in t, the parameters and the functions of this module.
    """
    return time_function(text, {name: p.value for name, p in resolve_parameters(parameters).items()})


def formula(text: str | float, variables: Sequence[str], **parameters: str | float) -> Formula:
    """A function of named variables from a text (or a number), with values for the parameters it names.

    Example: ``formula("b - ratio*a", ("t", "a", "b"), ratio=3)``. Raises ModelError as `expression` does.
    """
    return named_formula(text, variables, {name: p.value for name, p in resolve_parameters(parameters).items()})


def named_formula(text: str | float, variables: Sequence[str], parameters: Mapping[str, float]) -> Formula:
    """As `formula`, with parameters that are numbers already."""
    given = _direct(text)
    program = Program((Operation.CONSTANT,), (given,)) if given is not None else None
    return Formula(str(text), tuple(variables), *(program or compile_program(str(text), parameters, variables)))


def constant(text: str | float, parameters: Mapping[str, float] | None = None) -> float:
    """The value (SI units) of a number, ``number unit`` or an expression in parameters; `t` is refused.

    Raises ModelError with the text and the reason.
    """
    given = _direct(text)
    if given is not None:
        return given
    codes, values = compile_program(str(text), parameters or {}, ())
    assert codes == (Operation.CONSTANT,)  # without variables everything folds
    return values[0]


def time_function(text: str | float, parameters: Mapping[str, float]) -> TimeFunction:
    """As `expression`, with parameters that are numbers already."""
    given = _direct(text)
    program = Program((Operation.CONSTANT,), (given,)) if given is not None else None
    return TimeFunction(str(text), *(program or compile_program(str(text), parameters, TIME)))


def value_at(function: TimeFunction, times: Sequence[float]) -> list[float]:
    """Values of a function at times (s), without derivatives; NaN or infinite where it is not defined."""
    at = np.asarray(times, dtype=np.float64)
    return [float(value) for value in evaluate(function.codes, function.values, [at])]


def resolve_parameters(definitions: Mapping[str, str | float]) -> dict[str, Parameter]:
    """Values of parameters that may refer to each other, in SI units.

    Raises ModelErrors with every bad name, bad expression and cycle; paths are ``parameters.<name>``.
    """
    if len(definitions) > MAX_PARAMETERS:
        raise ModelError(f"{len(definitions)} parameters are more than {MAX_PARAMETERS}", path="parameters")
    errors: list[ModelError] = []
    needs: dict[str, set[str]] = {}
    resolved: dict[str, Parameter] = {}
    broken: set[str] = set()
    for name, given in definitions.items():
        try:
            check_variable_name(name)
            quantity = parse_quantity(given) if isinstance(given, str) else None
            if quantity is not None:
                resolved[name] = Parameter(quantity.value, quantity.dimension)
            elif isinstance(given, str):
                needs[name] = names_in(given) & definitions.keys()
            else:
                resolved[name] = Parameter(_finite(given))
        except ModelError as error:
            errors.append(_at_parameter(error, name))
            broken.add(name)
    try:
        order = [name for name in TopologicalSorter(needs).static_order() if name in needs]
    except CycleError as cycle:
        order = []
        members: list[str] = cycle.args[1]
        errors.append(
            ModelError(
                f"parameters refer to each other in a circle: {' -> '.join(reversed(members))}",
                path=f"parameters.{members[-1]}",
                remedy="give one of them a value",
            )
        )
    for name in order:
        if needs[name] & broken:
            broken.add(name)
            continue
        try:
            known = {other: parameter.value for other, parameter in resolved.items()}
            resolved[name] = Parameter(constant(str(definitions[name]), known))
        except ModelError as error:
            errors.append(_at_parameter(error, name))
            broken.add(name)
    if errors:
        raise ModelErrors(errors)
    return resolved


def compile_program(text: str, parameters: Mapping[str, float], variables: Sequence[str]) -> Program:
    """Compile an expression in some variables (`t`, or `x`, `y`, `z`); constant parts are folded.

    Raises ModelError with the text and the reason.
    """
    instructions = _Compiler(text, parameters, variables).compile(_parse(text), 0)
    depth = height = 0
    for code, _ in instructions:
        height += 1 if code in (Operation.CONSTANT, Operation.VARIABLE) else -1 if code in BINARY else 0
        depth = max(depth, height)
    if depth > MAX_STACK:
        raise _refuse(text, f"needs {depth} intermediate results at once, more than {MAX_STACK}")
    return Program(tuple(int(code) for code, _ in instructions), tuple(value for _, value in instructions))


def names_in(text: str) -> set[str]:
    """All names that an expression mentions (functions included). Raises ModelError if it cannot be parsed."""
    return {node.id for node in ast.walk(_parse(text)) if isinstance(node, ast.Name)}


class _Compiler:
    """One walk over a syntax tree, giving postfix instructions."""

    def __init__(self, text: str, parameters: Mapping[str, float], variables: Sequence[str]) -> None:
        self.text = text
        self.parameters = parameters
        self.places = {name: float(place) for place, name in enumerate(variables)}
        self.dotted = any("." in name for name in variables)

    def compile(self, node: ast.expr, depth: int) -> list[Instruction]:
        if depth > MAX_DEPTH:
            raise _refuse(self.text, f"is nested more than {MAX_DEPTH} deep")
        match node:
            case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
                return [self._number(number)]
            case ast.Name(id=name):
                return [self._name(name)]
            case ast.Attribute() if self.dotted and (dotted := _dotted(node)) is not None:
                return [self._name(dotted)]
            case ast.UnaryOp(op=ast.UAdd()):
                return self.compile(node.operand, depth + 1)
            case ast.UnaryOp(op=ast.USub()):
                return self._join(Operation.NEGATE, self.compile(node.operand, depth + 1))
            case ast.BinOp() if type(node.op) in _OPERATORS:
                left = self.compile(node.left, depth + 1)
                return self._join(_OPERATORS[type(node.op)], left, self.compile(node.right, depth + 1))
            case ast.BinOp(op=ast.BitXor()):
                raise _refuse(self.text, "'^' is not an operator here", "write ** for powers")
            case ast.Call(func=ast.Name(id=name), keywords=[]):
                return self._call(name, node.args, depth)
        raise _refuse(
            self.text,
            f"{_describe(node)} is not allowed in an expression",
            "use numbers, parameters, + - * / **, parentheses and the functions " + ", ".join(sorted(FUNCTIONS)),
        )

    def _number(self, number: float) -> Instruction:
        try:
            value = float(number)
        except OverflowError:
            value = math.inf
        if not math.isfinite(value):
            raise _refuse(self.text, "a number in it is too large")
        return Operation.CONSTANT, value

    def _name(self, name: str) -> Instruction:
        if name in self.places:
            if name in self.parameters:
                raise _refuse(self.text, f"'{name}' is both a parameter and a coordinate", "rename the parameter")
            return Operation.VARIABLE, self.places[name]
        if name == "pi":
            return Operation.CONSTANT, math.pi
        if name in self.parameters:
            return Operation.CONSTANT, float(self.parameters[name])
        if name == "t":
            raise _refuse(self.text, "the time t cannot stand here", "use a constant; t may stand in drivers and loads")
        if name in FUNCTIONS:
            raise _refuse(self.text, f"the function {name} has no arguments", f"write {name}(…)")
        known = [*self.parameters, *self.places, "pi"]
        near = nearest(name, [*known, *FUNCTIONS])
        hint = f"did you mean '{near}'?" if near else f"known names are {', '.join(known[:20])}"
        raise _refuse(self.text, f"unknown name '{name}'", hint)

    def _call(self, name: str, arguments: list[ast.expr], depth: int) -> list[Instruction]:
        parts = [self.compile(argument, depth + 1) for argument in arguments]
        if name in _ONE_ARGUMENT:
            self._count(name, parts, 1)
            return self._join(_ONE_ARGUMENT[name], parts[0])
        if name in _MANY_ARGUMENTS:
            self._count(name, parts, None)
            result = parts[0]
            for part in parts[1:]:
                result = self._join(_MANY_ARGUMENTS[name], result, part)
            return result
        if name == "atan":
            self._count(name, parts, 1)
            return self._join(Operation.ATAN2, parts[0], [(Operation.CONSTANT, 1.0)])
        if name == "atan2":
            self._count(name, parts, 2)
            return self._join(Operation.ATAN2, parts[0], parts[1])
        if name == "smoothstep":
            self._count(name, parts, 3)
            x, x0, x1 = parts
            run = self._join(Operation.SUBTRACT, x1, x0)
            share = self._join(Operation.DIVIDE, self._join(Operation.SUBTRACT, x, x0), run)
            return self._join(Operation.SMOOTHSTEP, share)
        near = nearest(name, FUNCTIONS)
        hint = f"did you mean '{near}'?" if near else f"known functions are {', '.join(sorted(FUNCTIONS))}"
        raise _refuse(self.text, f"unknown function '{name}'", hint)

    def _count(self, name: str, parts: list[list[Instruction]], wanted: int | None) -> None:
        if (wanted is None and not parts) or (wanted is not None and len(parts) != wanted):
            count = "one or more arguments" if wanted is None else f"{wanted} argument{'s' if wanted > 1 else ''}"
            raise _refuse(self.text, f"{name} takes {count}, found {len(parts)}")

    def _join(self, operation: Operation, *parts: list[Instruction]) -> list[Instruction]:
        """The operation on its arguments; computed at once if all are constants."""
        if operation is Operation.DIVIDE and parts[1] == [(Operation.CONSTANT, 0.0)]:
            raise _refuse(self.text, "division by zero")
        if any(len(part) > 1 or part[0][0] != Operation.CONSTANT for part in parts):
            return [*(instruction for part in parts for instruction in part), (operation, 0.0)]
        numbers = [np.float64(part[0][1]) for part in parts]
        with np.errstate(all="ignore"):
            value = float(ON_ARRAYS[operation](*numbers))
        if math.isfinite(value):
            return [(Operation.CONSTANT, value)]
        shown = ", ".join(f"{number:.6g}" for number in numbers)
        what = f"{_SYMBOLS.get(operation, operation.name.lower())} of {shown}"
        if math.isnan(value):
            raise _refuse(self.text, f"{what} is not a real number")
        raise _refuse(self.text, f"{what} is too large or infinite")


def _dotted(node: ast.expr) -> str | None:
    """``hub.v.x`` as one name; None for an attribute of anything but names."""
    parts: list[str] = []
    while isinstance(node, ast.Attribute):
        parts.append(node.attr)
        node = node.value
    return ".".join([node.id, *reversed(parts)]) if isinstance(node, ast.Name) else None


def _parse(text: str) -> ast.expr:
    if len(text) > MAX_LENGTH:
        raise _refuse(text[:40] + "…", f"has {len(text)} characters, more than {MAX_LENGTH}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # such as "invalid decimal literal": the text is the user's, not code
            return ast.parse(text.strip(), mode="eval").body
    except SyntaxError as error:
        place = f"at character {error.offset}" if error.offset else "in it"
        raise _refuse(
            text, f"is not an expression (something is wrong {place})", "check operators and parentheses"
        ) from None
    except (ValueError, RecursionError, MemoryError):
        raise _refuse(text, "is not an expression") from None


def _direct(text: str | float) -> float | None:
    """The value of a number or of ``number unit``; None for an expression."""
    if not isinstance(text, str):
        return _finite(text)
    quantity = parse_quantity(text)
    return None if quantity is None else quantity.value


def _finite(number: float) -> float:
    if isinstance(number, bool) or not isinstance(number, (int, float)):
        raise ModelError(f"expected a number or an expression, found {number!r:.40}")
    try:
        value = float(number)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise ModelError(f"expected a finite number, found {value}")
    return value


def check_variable_name(name: str, what: str = "a parameter") -> None:
    """Raise ModelError for a name that an expression could not use, or that means something else there."""
    if not _NAME.fullmatch(name) or keyword.iskeyword(name) or len(name) > 64:
        raise ModelError(
            f"'{name[:64]}' cannot name {what}",
            remedy="use at most 64 letters, digits and _, beginning with a letter",
        )
    if name in RESERVED:
        raise ModelError(f"'{name}' has a meaning in expressions and cannot name {what}", remedy="rename it")


def _at_parameter(error: ModelError, name: str) -> ModelError:
    return ModelError(error.message, path=f"parameters.{name}", remedy=error.remedy)


def _refuse(text: str, reason: str, remedy: str = "") -> ModelError:
    shown = text if len(text) <= 80 else text[:80] + "…"
    joint = " " if reason.startswith(("is ", "has ", "needs ")) else ": "
    return ModelError(f"expression '{shown}'{joint}{reason}", remedy=remedy)


def _describe(node: ast.expr) -> str:
    match node:
        case ast.Attribute(attr=name):
            return f"the attribute '.{name[:40]}'"
        case ast.Call(keywords=[_, *_]):
            return "an argument by name"
        case ast.Call():
            return "a call of something other than a function's name"
        case ast.Constant(value=value):
            return f"the {type(value).__name__} {repr(value)[:40]}"
        case ast.Compare() | ast.BoolOp():
            return "a comparison"
        case ast.BinOp() | ast.UnaryOp():
            return "an operator other than + - * / **"
    return f"'{type(node).__name__.lower()}'"
