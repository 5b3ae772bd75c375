"""What a study file names: patterns of files and files beside it, or what is bundled."""

from pathlib import Path

from ....base.errors import InputError

_WILD = "*?["


def find_things(texts: list[str], folder: Path) -> dict[str, str]:
    """Return what is to be loaded by what the study calls it: files from `folder`, or a name.

    A pattern stands for the files that match it, sorted; what is behind ``#`` chooses within each.

    Raises `InputError` if no file matches, or two have one name.
    """
    found: dict[str, str] = {}
    for text in texts:
        for name in _matching(text, folder) if any(mark in text for mark in _WILD) else [text]:
            if name in found:
                raise InputError(f"{name}: expected each once, got it twice; name it once")
            found[name] = _in_folder(name, folder)
    return found


def policy_text_in(folder: Path, text: str) -> str:
    """Return the text of a policy with the path of its file, if it is of one, from `folder`."""
    file, colon, rest = text.partition(":")
    return f"{folder / file}{colon}{rest}" if file.endswith(".py") else text


def _matching(text: str, folder: Path) -> list[str]:
    pattern, mark, selector = text.partition("#")
    start = Path(pattern).anchor
    root = Path(start) if start else folder
    try:
        paths = sorted(path for path in root.glob(pattern.removeprefix(start)) if path.is_file())
    except (ValueError, NotImplementedError) as error:
        raise InputError(f"expected a pattern of files, got {text!r}: {error}") from error
    if not paths:
        raise InputError(f"expected files that match {text}, got none; check the pattern")
    named = (path if start else path.relative_to(folder) for path in paths)
    return [f"{path.as_posix()}{mark}{selector}" for path in named]


def _in_folder(name: str, folder: Path) -> str:
    file = name.partition("#")[0]
    path = Path(file)
    names_a_file = path.suffix != "" or len(path.parts) > 1 or (folder / path).is_file()
    return str(folder / name) if names_a_file else name
