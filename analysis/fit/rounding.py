"""How many digits a profile states: more would differ from machine to machine."""


def to_digits(value: float, digits: int = 4) -> float:
    """Return a number of so many significant digits."""
    return float(f"{value:.{digits}g}")
