"""Contract checks of policies, for the registered ones and for anybody's own."""

from .check_policy import CHECKS, CheckResult, check_policy, parametrize_with_checks

__all__ = ["CHECKS", "CheckResult", "check_policy", "parametrize_with_checks"]
