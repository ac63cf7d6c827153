"""Pictures of results and of models; nothing here needs a display."""
