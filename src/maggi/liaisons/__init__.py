"""Liaisons: joints and drivers as rows on the twists of attachments (Eq. T7)."""
