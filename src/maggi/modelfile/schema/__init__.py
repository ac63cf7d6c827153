"""The schema of model files: pydantic models of every section, each of which builds its frozen description."""
