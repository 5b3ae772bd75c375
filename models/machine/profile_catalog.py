"""Hardware profiles by name: the bundled ones, or any TOML file."""

from os import PathLike
from pathlib import Path

from ...base.errors import InputError, is_file, text_of
from ...base.nearest_names import unknown_name
from .hardware import HardwareProfile
from .profile_file import read_profile

_SUFFIX = ".toml"
_FOLDER = Path(__file__).parent / "profiles"


def list_hardware() -> tuple[str, ...]:
    """Return the names of the bundled profiles, sorted."""
    return tuple(sorted(path.stem for path in _FOLDER.glob(f"*{_SUFFIX}")))


def load_hardware(name_or_path: str | PathLike[str] | HardwareProfile) -> HardwareProfile:
    """Return the bundled profile of that name, or the one in the TOML file of that path.

    A profile is returned as it is.

    Raises `InputError` if there is neither, with the nearest bundled name; or if the file is not a
    profile.
    """
    if isinstance(name_or_path, HardwareProfile):
        return name_or_path
    spec, names = text_of(name_or_path, "hardware", HardwareProfile), list_hardware()
    if spec in names:
        return read_profile(_FOLDER / f"{spec}{_SUFFIX}")
    path = Path(spec)
    if path.suffix == _SUFFIX or is_file(path):
        return read_profile(path)
    raise InputError(f"hardware: {unknown_name(spec, names, instead=f'a {_SUFFIX} file')}")
