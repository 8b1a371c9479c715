"""What the user must be told about a render, collected so that nothing is said twice."""

from __future__ import annotations

MAX_NAMES = 50


class Report:
    """Warnings in the order in which they first came up; objects that share a sentence share one
    warning.
    """

    def __init__(self) -> None:
        self._sentences: dict[str, dict[str, None]] = {}
        self._missing: set[str] = set()

    def warn(self, sentence: str, name: str | None = None, *, missing: bool = False) -> None:
        """Add `sentence`; with a `name`, `sentence` holds "{}" where the quoted names of all that
        share it are put. missing: a file is not there.
        """
        if missing:
            self._missing.add(sentence)
        names = self._sentences.setdefault(sentence, {})
        if name is not None:
            names[name] = None

    def add(self, other: Report) -> None:
        """Add all warnings of another report."""
        for sentence, names in other._sentences.items():
            self._sentences.setdefault(sentence, {}).update(names)
        self._missing |= other._missing

    def messages(self, *, of_missing: bool = False) -> list[str]:
        """All warnings, or those of files that are not there."""
        return [
            readable(sentence.replace("{}", _enumerate(list(names))) if names else sentence)
            for sentence, names in self._sentences.items()
            if not of_missing or sentence in self._missing
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
