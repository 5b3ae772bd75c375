"""What is said about a name that nobody knows."""

import difflib
from collections.abc import Iterable

_MOST = 40  # names that one line can list


def unknown_name(
    got: str, known: Iterable[str], *, instead: str = "", advice: str = "name one of them"
) -> str:
    """Return ``expected one of A, B, got X; did you mean A?``, or the advice if none is near.

    Parameters
    ----------
    instead
        What may stand there in place of a name, such as ``a file``.
    """
    names = list(known)
    shown = (got if got.isprintable() else repr(got)) or "nothing"
    if not names:
        return f"expected no such name, got {shown}; remove it"
    near = difflib.get_close_matches(got, names, n=1)
    expected = ", ".join(names[:_MOST]) + (", …" if len(names) > _MOST else "")
    expected += f" or {instead}" if instead else ""
    hint = f"did you mean {near[0]}?" if near else advice
    return f"expected one of {expected}, got {shown}; {hint}"
