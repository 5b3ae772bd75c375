"""Compare level-of-detail policies on the same footing."""

from lodbench.base.errors import InputError, LodbenchError, PolicyError
from lodbench.base.version import __version__

__all__ = ["InputError", "LodbenchError", "PolicyError", "__version__"]
