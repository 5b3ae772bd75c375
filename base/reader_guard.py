"""The guard around every reader: whatever a file makes a reader do, the user gets one line.

Readers say what is wrong where they know it.  What they did not think of, of a million damaged
files, ends here: any exception becomes an `InputError` with the path, and warnings that libraries
print about a file are swallowed.
"""

import warnings
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from .errors import InputError, LodbenchError, about_file
from .foreign_text import describe_error


@contextmanager
def guarded(path: str | Path, what: str, advice: str = "write it again") -> Generator[None]:
    """Turn what reading a file raises into an InputError that names it.

    Errors of lodbench itself pass, with the path if they have none; so does an interruption.

    Parameters
    ----------
    what, advice
        What the file should be, and what to do, for the message.
    """
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"), about_file(path):
            warnings.simplefilter("ignore")
            yield
    except LodbenchError:
        raise
    except MemoryError as error:
        message = f"expected {what} that fits into memory, got one that does not"
        raise InputError(f"{message}; split it", path=path) from error
    except RecursionError as error:
        message = f"expected {what}, got one that is nested too deep"
        raise InputError(f"{message}; {advice}", path=path) from error
    except ImportError as error:
        message = f"expected the libraries that read {what}, got {describe_error(error)[:120]}"
        raise InputError(f"{message}; install lodbench anew", path=path) from error
    except OSError as error:
        reason = error.strerror or describe_error(error)
        message = f"expected {what} that can be read, got {reason}"
        raise InputError(f"{message}; check the path", path=path) from error
    except Exception as error:
        message = f"expected {what}, got one that cannot be read ({describe_error(error)[:120]})"
        raise InputError(f"{message}; {advice}", path=path) from error
