"""Bodies in moving frames: rigid, Ritz, meshed, prescribed; their attachments."""
