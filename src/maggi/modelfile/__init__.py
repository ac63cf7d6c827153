"""Model files: YAML or JSON text to a frozen `Model`, with every mistake at its line and column."""

from .json_schema import json_schema
from .read import read, read_text
from .source import SourceMap

__all__ = ["SourceMap", "json_schema", "read", "read_text"]
