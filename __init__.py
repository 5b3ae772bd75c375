"""Compare level-of-detail policies on the same footing."""

from .errors import InputError, LodbenchError, PolicyError

__all__ = ["InputError", "LodbenchError", "PolicyError", "__version__"]

__version__ = "0.1.0"
