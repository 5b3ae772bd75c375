"""Things that have names: ours, imported when they are asked for, and those of a user."""

import re
from collections.abc import Collection, Iterator, Mapping
from importlib import import_module
from typing import Any, Generic, TypeVar

from .errors import InputError
from .nearest_names import unknown_name
from .user_code import load_object

Thing = TypeVar("Thing")


_NAME = re.compile(r"[A-Za-z0-9][\w.+-]*")


class Registry(Collection[str], Generic[Thing]):
    """Things of one kind by their names, a user's before ours and each in the order of entry.

    A thing of a user goes by a name of its own after `register`, or is named as ``file.py:NAME`` or
    ``package.module:NAME``.

    Parameters
    ----------
    what : what the things are, as messages call them
    kind : the class that all are instances of
    package : the package of the modules below
    ours : by name, ``module:NAME`` in that package
    """

    def __init__(self, what: str, kind: Any, package: str, ours: Mapping[str, str]) -> None:
        self._what, self._kind, self._package, self._ours = what, kind, package, dict(ours)
        self._users: dict[str, Thing] = {}

    def __iter__(self) -> Iterator[str]:
        yield from self._users
        yield from self._ours

    def __len__(self) -> int:
        return len(self._users) + len(self._ours)

    def __contains__(self, name: object) -> bool:
        return name in self._users or name in self._ours

    @property
    def users(self) -> dict[str, Thing]:
        """The things of a user that have a name of their own."""
        return dict(self._users)

    def find(self, name: str) -> Thing:
        """Return the thing of a name.

        Raises `InputError` if there is none, with the nearest name, or if a user's module does not
        load, or holds something else.
        """
        if name in self._users:
            return self._users[name]
        if name in self._ours:
            module, _, attribute = self._ours[name].partition(":")
            return getattr(import_module(f".{module}", self._package), attribute)
        if ":" in name:
            return self._of_kind(name, load_object(name, self._what))
        own = "your own as file.py:NAME"
        raise InputError(f"{self._what}: {unknown_name(name, self, instead=own)}")

    def register(self, name: str, thing: Thing) -> None:
        """Give a user's thing a name in this process; the last one of a name counts.

        Raises `InputError` if the name is one of ours or could not be typed as one, or the thing is
        of another kind.
        """
        good = isinstance(name, str) and _NAME.fullmatch(name)  # pyright: ignore[reportUnnecessaryIsInstance]
        if not good or name in self._ours:
            raise InputError(
                f"{self._what}: expected a name of its own of letters, digits, - and _, "
                f"got {name!r}; choose another"
            )
        self._users[name] = self._of_kind(name, thing)

    def _of_kind(self, name: str, thing: Any) -> Thing:
        if isinstance(thing, self._kind):
            return thing
        kind, got = self._kind.__name__, type(thing).__name__
        raise InputError(f"{self._what} {name}: expected a {kind}, got {got}")
