"""What several options say of two eyes."""

from typing import TYPE_CHECKING

from ...base.errors import InputError
from .picture_size import parse_size

if TYPE_CHECKING:
    from ...models.scene.rig import Eyes


def make_eyes(apart_m: float | None, size: str | None, *, single_pass: bool) -> "Eyes | None":
    """Return the eyes that options ask for, None where there is one camera.

    Raises `InputError` if no head has them, or they are described and not asked for.
    """
    from ...models.scene.rig import Eyes

    if apart_m is not None:
        size_px = None if size is None else parse_size(size, "--eye-size")
        return Eyes(apart_m=apart_m, size_px=size_px, single_pass=single_pass)
    for option, given in (("--eye-size", size is not None), ("--single-pass", single_pass)):
        if given:
            raise InputError(
                f"{option}: expected two eyes, got one camera; add --eyes and how many metres they "
                "are apart, such as --eyes 0.064"
            )
    return None
