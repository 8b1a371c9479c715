"""What the user must be told about a render, collected so that nothing is said twice."""

from __future__ import annotations

MAX_NAMES = 50


class Report:
    """Warnings in the order in which they first came up; objects that share a sentence share one
    warning.
    """

    def __init__(self) -> None:
        self._sentences: dict[str, dict[str, None]] = {}

    def warn(self, sentence: str, name: str | None = None) -> None:
        """Add `sentence`; with a `name`, `sentence` holds "{}" where the quoted names of all that
        share it are put.
        """
        names = self._sentences.setdefault(sentence, {})
        if name is not None:
            names[name] = None

    def add(self, other: Report) -> None:
        """Add all warnings of another report."""
        for sentence, names in other._sentences.items():
            self._sentences.setdefault(sentence, {}).update(names)

    def messages(self) -> list[str]:
        return [
            readable(sentence.replace("{}", _enumerate(list(names))) if names else sentence)
            for sentence, names in self._sentences.items()
        ]


def readable(text: str) -> str:
    """Paths hold bytes of any kind; what is no UTF-8 is written as \\xff, as Blender, files and
    terminals refuse it.
    """
    try:
        return text.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")
    except UnicodeEncodeError:  # no byte of a path either
        return text.encode("utf-8", "backslashreplace").decode("utf-8")


def _enumerate(names: list[str]) -> str:
    shown = ", ".join(f"'{name}'" for name in names[:MAX_NAMES])
    return f"{shown} and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else shown
