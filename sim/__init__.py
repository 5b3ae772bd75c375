"""The frame-level discrete-event simulator."""
