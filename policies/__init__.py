"""Level-of-detail policies, one a file, and the names that a policy of one's own needs."""

from .protocol import Capabilities, Policy
from .selection import Selection, Work
from .view import View

__all__ = ["Capabilities", "Policy", "Selection", "View", "Work"]
