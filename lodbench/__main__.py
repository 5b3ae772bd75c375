"""``python -m lodbench`` is the command ``lodbench``."""

from lodbench.cli.main import main

if __name__ == "__main__":
    main()
